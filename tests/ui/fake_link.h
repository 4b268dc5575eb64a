#pragma once
// Takes the engine's place in tests of the window: notes what it was asked for, and publishes frames that the test makes.
#include <QStringList>

#include "ui/engine_link.h"

namespace hl::ui {

class FakeLink : public EngineLink {
 public:
  QStringList calls;
  Preset loaded;
  std::shared_ptr<const FrameResult> frame;
  std::vector<std::string> wanted;
  std::optional<std::vector<Region>> regions;
  std::optional<std::vector<vec3>> probes;
  Playback playback;
  std::vector<CameraPath> paths;
  std::shared_ptr<Progress> work = std::make_shared<Progress>();

  void publish(std::shared_ptr<const FrameResult> f) {
    frame = std::move(f);
    emit frameReady();
  }
  QStringList takeCalls() { return std::exchange(calls, {}); }

  void load(const Preset& p) override { loaded = p, note("load " + p.scene); }
  void open(const QString& path) override { calls << "open " + path; }
  void openScene(const QString& s) override { calls << "openScene " + s; }
  void setTechnique(const std::string& id, const std::map<std::string, std::string>& parameters) override {
    std::string text = "technique " + id;
    for (const auto& [key, value] : parameters) text += " " + key + "=" + value;
    note(text);
  }
  void setParam(const std::string& key, const std::string& text) override { note("param " + key + "=" + text); }
  void setCamera(const Camera&) override { note("camera"); }
  void setCameraName(const std::string& name) override { note("camera " + name); }
  void setLights(const LightEdits&) override { note("lights"); }
  void setResolution(int w, int h) override { note("resolution " + std::to_string(w) + "x" + std::to_string(h)); }
  void setSeed(uint32_t s) override { note("seed " + std::to_string(s)); }
  void setDisplay(const Display& d) override { note("display " + d.view + " " + std::to_string(d.exposure)); }
  void setPlayback(const Playback& p) override {
    playback = p;
    note(std::string("playback ") + (p.play ? "on" : "off"));
  }
  void setCameraPaths(const std::vector<CameraPath>& p) override {
    paths = p;
    note("camera paths " + std::to_string(p.size()));
  }
  void pick(int x, int y) override { note("pick " + std::to_string(x) + " " + std::to_string(y)); }
  void setReferenceWanted(bool on) override { note(on ? "reference on" : "reference off"); }
  void setImagesWanted(const std::vector<std::string>& names) override {
    wanted = names;
    note("images " + std::to_string(names.size()));
  }
  void setRegions(const std::optional<std::vector<Region>>& r) override {
    regions = r;
    note(r ? "regions " + std::to_string(r->size()) : "regions of the scene");
  }
  void setProbes(const std::optional<std::vector<vec3>>& p) override {
    probes = p;
    note(p ? "probes " + std::to_string(p->size()) : "probes of the scene");
  }
  void setWorkPaused(bool) override { note("pause work"); }
  void cancelWork() override { note("cancel work"); }
  void restartWork() override { note("restart work"); }
  void resetTechnique() override { note("reset technique"); }
  void reloadShaders() override { note("reload shaders"); }
  void requestPreset(quint64 ticket) override {
    note("request preset");
    lastTicket = ticket;
  }
  /// Answered at once: with `forecast`, or, where that is empty, that nothing takes long. Not at all with `silent`.
  void requestForecast(quint64 ticket, const std::map<std::string, std::string>& changes, const std::optional<std::optional<std::vector<vec3>>>&) override {
    forecastTicket = ticket, forecastOf = changes;
    if (!silent) emit forecastIs(forecast.value_or(RebuildForecast{}), ticket);
  }
  std::optional<RebuildForecast> forecast;
  bool silent = false;
  quint64 forecastTicket = 0;
  std::map<std::string, std::string> forecastOf;
  void savePreset(const Preset& p, const QString& path) override {
    loaded = p;
    calls << "save " + path;
    emit saved(path, QStringLiteral("preset"));
  }
  void saveScene(std::shared_ptr<const FrameResult>, const QString&) override { note("save scene"); }
  void saveScreenshot(std::shared_ptr<const FrameResult> f, const Preset& p, const QString& path) override {
    saidFrame = std::move(f);
    loaded = p;
    calls << "screenshot " + path;
    emit saved(path, QStringLiteral("screenshot"));
  }
  void restart() override { note("restart"); }
  void cancel() override { note("cancel"); }
  void setVisible(bool on) override { note(on ? "visible" : "hidden"); }
  void setPaused(bool on) override { note(on ? "paused" : "running"); }
  std::shared_ptr<const FrameResult> latest() const override { return frame; }
  std::shared_ptr<const Progress> progress() const override { return work; }
  SessionOptions sessionOptions() const override { return {}; }
  std::shared_ptr<SessionGate> gate() const override { return gate_; }

  quint64 lastTicket = 0;
  std::shared_ptr<const FrameResult> saidFrame;  ///< of the last screenshot

 private:
  std::shared_ptr<SessionGate> gate_ = std::make_shared<SessionGate>();
  void note(const std::string& text) { calls << QString::fromStdString(text); }
};

}  // namespace hl::ui
