#include "ui/session_link.h"

#include <QMetaObject>
#include <string_view>
#include <utility>

#include "engine/experiment/open_target.h"
#include "ui/files.h"

namespace hl::ui {

SessionLink::SessionLink(const SessionOptions& options, QObject* parent)
    : EngineLink(parent), options_(options) {
  files_.setMaxThreadCount(1);  // writes keep their order
  start();
}

void SessionLink::restart() {
  thread_.reset();  // its thread has ended by itself when the device was lost
  start();
}

void SessionLink::start() {
  ++epoch_;
  announced_ = nullptr;  // no thread runs
  thread_ = std::make_unique<SessionThread>(options_, gate_);
  thread_->setCallbacks(
      [this] {
        // One waiting event is enough however fast frames come: its receiver takes the newest.
        if (framePending_.exchange(true)) return;
        QMetaObject::invokeMethod(
            this,
            [this] {
              framePending_ = false;
              emit frameReady();
            },
            Qt::QueuedConnection);
      },
      [this](const Error& e) { report(e); });
}

SessionLink::~SessionLink() {
  thread_.reset();
  files_.waitForDone();
}

void SessionLink::post(const std::string& key, Edit edit) {
  thread_->post(withPresenter(std::move(edit)), key + "@" + std::to_string(epoch_));
}

void SessionLink::postBarrier(Edit edit) {
  ++epoch_;
  thread_->post(withPresenter(std::move(edit)));
}

/// The presenter comes with the session, which its own thread makes: the first edit there tells.
SessionLink::Edit SessionLink::withPresenter(Edit edit) {
  return [this, edit = std::move(edit)](Session& s) {
    if (std::exchange(announced_, &s) != &s)
      QMetaObject::invokeMethod(this, [this, presenter = s.presenter()] { emit presenterReady(presenter); }, Qt::QueuedConnection);
    edit(s);
  };
}

void SessionLink::report(const Error& error) {
  const QString message = QString::fromUtf8(error.what());
  const ErrorKind kind = error.kind();
  QMetaObject::invokeMethod(this, [this, message, kind] { emit failed(message, kind); }, Qt::QueuedConnection);
}

void SessionLink::announce(const Preset& preset, const QString& from) {
  QMetaObject::invokeMethod(this, [this, preset, from] { emit opened(preset, from); }, Qt::QueuedConnection);
}

void SessionLink::load(const Preset& preset) {
  postBarrier([this, preset](Session& s) {
    s.load(preset);
    loaded_ = true;
  });
}

void SessionLink::open(const QString& path) {
  postBarrier([this, path](Session& s) {
    const std::string name = path.toStdString();
    Preset file = name.empty() ? Preset{} : openTarget(name);
    // A scene or mesh alone changes the scene and nothing else, once there is an experiment to change.
    const bool sceneAlone = !name.empty() && file.file.empty() && file.scene == name;
    const std::vector<std::string> warnings = std::exchange(file.warnings, {});  // told once, by opened()
    try {
      if (sceneAlone && loaded_)
        s.setScene(name);
      else
        s.load(file);
    } catch (const Error& e) {
      // What is wrong may lie in another file that this one names.
      if (name.empty() || std::string_view(e.what()).find(name) != std::string_view::npos) throw;
      throw Error(e.kind(), name + ": " + e.what());
    }
    loaded_ = true;
    Preset preset = s.preset();
    preset.file = file.file;
    preset.warnings = warnings;
    announce(preset, path);
  });
}

void SessionLink::openScene(const QString& nameOrPath) {
  postBarrier([this, nameOrPath](Session& s) {
    s.setScene(nameOrPath.toStdString());
    announce(s.preset(), nameOrPath);
  });
}

void SessionLink::setTechnique(const std::string& id, const std::map<std::string, std::string>& parameters) {
  postBarrier([id, parameters](Session& s) {
    s.setTechnique(id);
    for (const auto& [key, text] : parameters) s.setParam(key, text);
  });
}

void SessionLink::setParam(const std::string& key, const std::string& text) {
  post("param " + key, [key, text](Session& s) { s.setParam(key, text); });
}

void SessionLink::setCamera(const Camera& camera) {
  post("camera", [camera](Session& s) { s.setCamera(camera); });
}
void SessionLink::setCameraName(const std::string& name) {
  post("camera", [name](Session& s) { s.setCameraName(name); });
}
void SessionLink::setLights(const LightEdits& l) {
  post("lights", [l](Session& s) { s.setLights(l.points, l.spots, l.directionals, l.sky); });
}
void SessionLink::setResolution(int width, int height) {
  post("resolution", [width, height](Session& s) { s.setResolution(width, height); });
}
void SessionLink::setSeed(uint32_t seed) {
  post("seed", [seed](Session& s) { s.setSeed(seed); });
}
void SessionLink::setDisplay(const Display& display) {
  post("display", [display](Session& s) { s.setDisplay(display); });
}
void SessionLink::setPlayback(const Playback& p) {
  post("playback", [p](Session& s) { s.setPlayback(p); });
}
void SessionLink::setCameraPaths(const std::vector<CameraPath>& paths) {
  post("camera paths", [paths](Session& s) { s.setCameraPaths(paths); });
}
void SessionLink::pick(int x, int y) {
  post("pick", [x, y](Session& s) { s.pick(x, y); });
}
void SessionLink::setReferenceWanted(bool wanted) {
  post("reference", [wanted](Session& s) { s.setReferenceWanted(wanted); });
}
void SessionLink::setImagesWanted(const std::vector<std::string>& names) {
  post("images", [names](Session& s) { s.setImagesWanted(names); });
  thread_->renderOnce();
}
void SessionLink::renderOnce() { thread_->renderOnce(); }
void SessionLink::setRegions(const std::optional<std::vector<Region>>& regions) {
  post("regions", [regions](Session& s) { s.setRegions(regions); });
}
void SessionLink::setProbes(const std::optional<std::vector<vec3>>& probes) {
  post("probes", [probes](Session& s) { s.setProbes(probes); });
}
void SessionLink::setWorkPaused(bool paused) {
  post("pause work", [paused](Session& s) { s.setWorkPaused(paused); });
}
void SessionLink::cancelWork() {
  thread_->cancel();
  post("work", [](Session& s) { s.cancelWork(); });
}
void SessionLink::restartWork() {
  post("work", [](Session& s) { s.restartWork(); });
}
void SessionLink::resetTechnique() {
  post("reset", [](Session& s) { s.resetTechnique(); });
}
void SessionLink::reloadShaders() {
  post("reload", [this](Session& s) {
    const ReloadReport report = s.reloadShaders();
    QMetaObject::invokeMethod(this, [this, report] { emit shadersReloaded(report); }, Qt::QueuedConnection);
  });
}

void SessionLink::requestPreset(quint64 ticket) {
  thread_->post([this, ticket](Session& s) {
    const Preset preset = s.preset();
    QMetaObject::invokeMethod(this, [this, preset, ticket] { emit presetIs(preset, ticket); }, Qt::QueuedConnection);
  });
}

void SessionLink::requestForecast(quint64 ticket, const std::map<std::string, std::string>& changes, const std::optional<std::optional<std::vector<vec3>>>& probes) {
  post("forecast", [this, ticket, changes, probes](Session& s) {
    RebuildForecast forecast;
    try {
      forecast = s.forecastRebuild(changes, probes);
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::Device) throw;
      forecast.rebuilds = true;
      if (e.kind() == ErrorKind::Cancelled) forecast.cancelled = true;
      else forecast.refused = e.what();
    }
    QMetaObject::invokeMethod(this, [this, forecast, ticket] { emit forecastIs(forecast, ticket); }, Qt::QueuedConnection);
  });
}

void SessionLink::write(std::function<void()> work, const QString& path, const QString& what) {
  files_.start([this, work = std::move(work), path, what] {
    try {
      work();
      QMetaObject::invokeMethod(this, [this, path, what] { emit saved(path, what); }, Qt::QueuedConnection);
    } catch (const Error& e) {
      report(e);
    } catch (const std::exception& e) {
      report(Error(ErrorKind::Run, path.toStdString() + ": " + e.what()));
    }
  });
}

void SessionLink::savePreset(const Preset& preset, const QString& path) {
  write([preset, path] { hl::savePreset(preset, path.toStdString()); }, path, QStringLiteral("preset"));
}
void SessionLink::saveScene(std::shared_ptr<const FrameResult> frame, const QString& path) {
  write([frame, path] { writeScene(*frame, path.toStdString()); }, path, QStringLiteral("scene"));
}
void SessionLink::saveScreenshot(std::shared_ptr<const FrameResult> frame, const Preset& preset, const QString& path) {
  write([frame, preset, path] { writeScreenshot(*frame, preset, path.toStdString()); }, path,
        QStringLiteral("screenshot"));
}

void SessionLink::cancel() { thread_->cancel(); }
void SessionLink::setVisible(bool visible) { thread_->setVisible(visible); }
void SessionLink::setPaused(bool paused) { thread_->setPaused(paused); }
std::shared_ptr<const FrameResult> SessionLink::latest() const { return thread_->latest(); }
std::shared_ptr<const Progress> SessionLink::progress() const { return thread_->progress(); }

}  // namespace hl::ui
