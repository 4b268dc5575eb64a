#pragma once
// The engine as it runs in the workbench: a SessionThread, and a worker thread for files.
#include <QThreadPool>
#include <atomic>

#include "engine/session/session_thread.h"
#include "ui/engine_link.h"

namespace hl::ui {

class SessionLink : public EngineLink {
  Q_OBJECT
 public:
  explicit SessionLink(const SessionOptions&, QObject* parent = nullptr);
  ~SessionLink() override;

  void load(const Preset&) override;
  void open(const QString& path) override;
  void openScene(const QString& nameOrPath) override;
  void setTechnique(const std::string& id, const std::map<std::string, std::string>& parameters) override;
  void setParam(const std::string& key, const std::string& text) override;
  void setCamera(const Camera&) override;
  void setCameraName(const std::string&) override;
  void setLights(const LightEdits&) override;
  void setResolution(int width, int height) override;
  void setSeed(uint32_t) override;
  void setDisplay(const Display&) override;
  void setPlayback(const Playback&) override;
  void setCameraPaths(const std::vector<CameraPath>&) override;
  void pick(int x, int y) override;
  void setReferenceWanted(bool) override;
  void setImagesWanted(const std::vector<std::string>& names) override;
  void renderOnce() override;
  void setRegions(const std::optional<std::vector<Region>>&) override;
  void setProbes(const std::optional<std::vector<vec3>>&) override;
  void setWorkPaused(bool) override;
  void cancelWork() override;
  void restartWork() override;
  void resetTechnique() override;
  void reloadShaders() override;
  void requestPreset(quint64 ticket) override;
  void requestForecast(quint64 ticket, const std::map<std::string, std::string>& changes, const std::optional<std::optional<std::vector<vec3>>>& probes) override;
  void savePreset(const Preset&, const QString& path) override;
  void saveScene(std::shared_ptr<const FrameResult>, const QString& path) override;
  void saveScreenshot(std::shared_ptr<const FrameResult>, const Preset&, const QString& path) override;
  void restart() override;
  void cancel() override;
  void setVisible(bool) override;
  void setPaused(bool) override;
  std::shared_ptr<const FrameResult> latest() const override;
  std::shared_ptr<const Progress> progress() const override;
  SessionOptions sessionOptions() const override { return options_; }
  std::shared_ptr<SessionGate> gate() const override { return gate_; }

 private:
  using Edit = std::function<void(Session&)>;
  /// Replaces a waiting edit of the same key, unless an edit that others depend on was posted in between.
  void post(const std::string& key, Edit);
  /// An edit that later ones build on: never replaced.
  void postBarrier(Edit);
  /// In the worker thread; an Error it throws comes back as failed().
  void write(std::function<void()> work, const QString& path, const QString& what);
  Edit withPresenter(Edit);
  void announce(const Preset&, const QString& from);  ///< from any thread
  void report(const Error&);                          ///< from any thread

  void start();

  SessionOptions options_;
  std::shared_ptr<SessionGate> gate_ = std::make_shared<SessionGate>();
  QThreadPool files_;
  std::atomic<bool> framePending_{false};
  quint64 epoch_ = 0;
  bool loaded_ = false;  // of the session's thread
  const Session* announced_ = nullptr;  // ... as well: whose presenter the window knows
  std::unique_ptr<SessionThread> thread_;  // last: it stops before anything it calls goes away
};

}  // namespace hl::ui
