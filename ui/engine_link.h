#pragma once
// What the window knows of the engine: edits go out, results come back, nothing waits. SessionLink is the real one; tests put their own in its place.
#include <QObject>
#include <QString>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/presenter.h"
#include "engine/session/session.h"
#include "engine/session/session_gate.h"

namespace hl::ui {

class EngineLink : public QObject {
  Q_OBJECT
 public:
  using QObject::QObject;

  // Edits. They return at once; a refused one comes back as failed(), and the session stays as it was.
  virtual void load(const Preset&) = 0;
  /// A preset, scene, mesh or screenshot; "" the default preset. Answered by opened() or failed().
  virtual void open(const QString& path) = 0;
  /// A scene by name or path, technique and parameters kept. Answered by opened() or failed().
  virtual void openScene(const QString& nameOrPath) = 0;
  /// The technique, then each of these of its parameters.
  virtual void setTechnique(const std::string& id, const std::map<std::string, std::string>& parameters) = 0;
  virtual void setParam(const std::string& key, const std::string& text) = 0;
  virtual void setCamera(const Camera&) = 0;
  virtual void setCameraName(const std::string&) = 0;
  virtual void setLights(const LightEdits&) = 0;
  virtual void setResolution(int width, int height) = 0;
  virtual void setSeed(uint32_t) = 0;
  virtual void setDisplay(const Display&) = 0;
  virtual void setPlayback(const Playback&) = 0;
  virtual void setCameraPaths(const std::vector<CameraPath>&) = 0;
  virtual void pick(int x, int y) = 0;
  virtual void setReferenceWanted(bool) = 0;
  /// FrameResult::images of the frames from now on; one frame comes at once, paused or not.
  virtual void setImagesWanted(const std::vector<std::string>& names) = 0;
  /// One frame more, paused or not.
  virtual void renderOnce() {}
  virtual void setRegions(const std::optional<std::vector<Region>>&) = 0;  ///< none: the scene's
  virtual void setProbes(const std::optional<std::vector<vec3>>&) = 0;  ///< by hand; none: the scene's
  virtual void setWorkPaused(bool) = 0;
  virtual void cancelWork() = 0;
  virtual void restartWork() = 0;
  virtual void resetTechnique() = 0;
  virtual void reloadShaders() = 0;
  /// The session's own preset, answered by presetIs() with the same ticket once all edits posted before it are through.
  virtual void requestPreset(quint64 ticket) = 0;
  /// What a rebuild after these changes would take (Session::forecastRebuild), answered by forecastIs() with the same ticket; of several that wait, the last alone.
  virtual void requestForecast(quint64 ticket, const std::map<std::string, std::string>& changes, const std::optional<std::optional<std::vector<vec3>>>& probes) = 0;
  /// Written off the window's thread. Answered by saved() or failed().
  virtual void savePreset(const Preset&, const QString& path) = 0;
  virtual void saveScene(std::shared_ptr<const FrameResult>, const QString& path) = 0;
  /// By the extension: .png what the frame shows, .exr its linear picture, which must be among its images.
  virtual void saveScreenshot(std::shared_ptr<const FrameResult>, const Preset&, const QString& path) = 0;

  /// Starts a new session where the old one has lost its device; whatever it held is gone.
  virtual void restart() = 0;
  /// Stops the running import, bake or reference at once.
  virtual void cancel() = 0;
  virtual void setVisible(bool) = 0;
  virtual void setPaused(bool) = 0;
  virtual std::shared_ptr<const FrameResult> latest() const = 0;
  virtual std::shared_ptr<const Progress> progress() const = 0;
  /// What another session is made with, so that it measures what this one shows.
  virtual SessionOptions sessionOptions() const = 0;
  /// Closed, the session rests: nothing else of ours runs while a sweep measures. It outlives the link where someone holds it.
  virtual std::shared_ptr<SessionGate> gate() const = 0;

 signals:
  /// Shows pictures from the device; comes with each session, before its first frame, where one has such a thing.
  void presenterReady(std::shared_ptr<hl::Presenter> presenter);
  void frameReady();
  void failed(const QString& message, hl::ErrorKind kind);
  void opened(const hl::Preset& preset, const QString& from);
  void presetIs(const hl::Preset& preset, quint64 ticket);
  void forecastIs(const hl::RebuildForecast& forecast, quint64 ticket);
  void saved(const QString& path, const QString& what);  ///< what: "preset", "scene", "screenshot"
  void shadersReloaded(const hl::ReloadReport& report);
};

}  // namespace hl::ui
