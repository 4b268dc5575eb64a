#include "ui/document.h"

#include <algorithm>
#include <utility>

#include "ui/undo_commands.h"

namespace hl::ui {
namespace {

const std::string kPlacementKey = "probes.placement", kByHand = "manual";

std::map<std::string, std::string> ofGroup(const std::map<std::string, std::string>& parameters, const std::string& group) {
  std::map<std::string, std::string> out;
  for (const auto& [key, text] : parameters)
    if (key.rfind(group + ".", 0) == 0) out[key] = text;
  return out;
}

std::string lightsText(const std::optional<LightEdits>& lights) {
  Preset p;
  p.lights = lights;
  return presetJson(p);
}

}  // namespace

LightEdits lightsOf(const Scene& s) { return {s.pointLights, s.spotLights, s.directionalLights, s.sky}; }

Document::Document(EngineLink& link, const Catalog& catalog, QObject* parent)
    : QObject(parent), link_(link), catalog_(catalog), pending_(link) {
  saved_ = savedForm();
  connect(&link, &EngineLink::opened, this, &Document::onOpened);
  connect(&link, &EngineLink::presetIs, this, &Document::onPresetIs);
  connect(&link, &EngineLink::frameReady, this, &Document::onFrame);
  connect(&link, &EngineLink::failed, this, [this] {
    // Which edit was refused is not told: the session says where it stands, once it has been through all the others.
    opening_ = std::max(0, opening_ - 1);
    link_.requestPreset(edits_);
  });
  connect(&link, &EngineLink::saved, this, [this](const QString&, const QString& what) {
    if (what != "preset" || !saving_) return;
    saved_ = *std::exchange(saving_, std::nullopt);
    updateModified();
  });
}

std::string Document::parameter(const std::string& key) const {
  const auto found = preset_.parameters.find(key);
  if (found != preset_.parameters.end()) return found->second;
  const ParamInfo* info = catalog_.parameter(preset_.technique, key);
  return info ? defaultText(*info) : std::string();
}

void Document::push(Preset target, const QString& what, quint64 drag) {
  undo_.push(new PresetCommand(*this, preset_, std::move(target), what, drag));
}

void Document::editParameters(const std::map<std::string, std::string>& texts, const QString& what, quint64 drag) {
  Preset target = preset_;
  for (const auto& [key, text] : texts) {
    const ParamInfo* info = catalog_.parameter(preset_.technique, key);
    if (info && text == defaultText(*info))
      target.parameters.erase(key);
    else
      target.parameters[key] = text;
  }
  if (target.parameters != preset_.parameters) push(std::move(target), what, drag);
}

void Document::editTechnique(const std::string& id) {
  if (id == preset_.technique || !catalog_.technique(id)) return;
  Preset target = preset_;
  const auto own = ofGroup(preset_.parameters, preset_.technique);
  otherTechniques_[preset_.technique] = own;
  for (const auto& [key, text] : own) target.parameters.erase(key);
  for (const auto& [key, text] : otherTechniques_[id]) target.parameters[key] = text;
  target.technique = id;
  bool known = false;
  for (const ViewInfo& view : catalog_.views(id)) known |= view.id == target.display.view;
  if (!known) target.display.view = "final";
  push(std::move(target), tr("technique %1").arg(QString::fromStdString(catalog_.technique(id)->label)), 0);
}

void Document::editDisplay(const Display& display, const QString& what, quint64 drag) {
  if (display == preset_.display) return;
  Preset target = preset_;
  target.display = display;
  push(std::move(target), what, drag);
}

void Document::editResolution(int width, int height) {
  if (width == preset_.width && height == preset_.height) return;
  Preset target = preset_;
  target.width = width, target.height = height;
  push(std::move(target), tr("resolution %1 x %2").arg(width).arg(height), 0);
}

void Document::editSeed(uint32_t seed) {
  if (seed == preset_.seed) return;
  Preset target = preset_;
  target.seed = seed;
  push(std::move(target), tr("seed %1").arg(seed), 0);
}

void Document::editLights(const LightEdits& lights, const QString& what, quint64 drag) {
  Preset target = preset_;
  target.lights = lights;
  if (lightsText(target.lights) != lightsText(preset_.lights)) push(std::move(target), what, drag);
}

void Document::editRegions(const std::optional<std::vector<Region>>& regions, const QString& what, quint64 drag) {
  if (regions == preset_.regions) return;
  Preset target = preset_;
  target.regions = regions;
  push(std::move(target), what, drag);
}

std::vector<Region> Document::regions() const { return preset_.regions ? *preset_.regions : sceneRegions_; }

void Document::editProbes(const std::optional<std::vector<vec3>>& probes, bool use, const QString& what) {
  Preset target = preset_;
  target.probes = probes;
  if (use) target.parameters["probes.placement"] = "manual";
  if (target.probes != preset_.probes || target.parameters != preset_.parameters) push(std::move(target), what, 0);
}

std::vector<vec3> Document::probes() const { return preset_.probes ? *preset_.probes : sceneProbes_; }

void Document::revertRebuild() {
  Preset target = preset_;
  for (const auto& [key, text] : pending_.parametersNow()) {
    const ParamInfo* info = catalog_.parameter(preset_.technique, key);
    if (info && text == defaultText(*info)) target.parameters.erase(key);
    else target.parameters[key] = text;
  }
  if (const auto probes = pending_.probesNow()) target.probes = *probes;
  push(std::move(target), tr("revert of what would be rebuilt"), 0);
}

void Document::restore(const Preset& preset, const QString& what) {
  Preset target = preset;
  target.file = preset_.file;
  target.warnings.clear();
  undo_.push(PresetCommand::whole(*this, preset_, std::move(target), what));
}

void Document::setPlayback(const Playback& playback) {
  preset_.animation = playback;
  ++edits_;
  link_.setPlayback(playback);
  emit presetChanged();
  updateModified();
}

void Document::keepCameraPaths(const std::vector<CameraPath>& paths) {
  ++edits_;
  link_.setCameraPaths(paths);
}

void Document::moveCamera(const Camera& camera) {
  preset_.camera = camera;
  leavePath();
  ++edits_;
  link_.setCamera(camera);
  emit cameraChanged(false);
  updateModified();
}

void Document::useCamera(const std::string& name) {
  preset_.cameraName = name;
  preset_.camera.reset();
  leavePath();
  ++edits_;
  link_.setCameraName(name);
  emit cameraChanged(true);
  updateModified();
}

void Document::leavePath() {
  if (preset_.animation.cameraPath.empty()) return;
  preset_.animation.cameraPath.clear();
  emit presetChanged();
}

std::optional<Camera> Document::camera() const {
  if (const auto frame = link_.latest(); frame && !preset_.animation.cameraPath.empty()) return frame->camera;
  if (preset_.camera) return preset_.camera;
  if (!scene_ || scene_->cameras.empty()) return std::nullopt;
  for (const Camera& c : scene_->cameras)
    if (c.name == preset_.cameraName) return c;
  return scene_->cameras.front();
}

void Document::sendLights(const std::optional<LightEdits>& lights) {
  if (lights)
    link_.setLights(*lights);
  else if (sceneLights_)
    link_.setLights(*sceneLights_);
}

void Document::sendTechnique(const Preset& target) {
  // Every parameter of its own is named, defaults too: the session may remember others from an earlier visit.
  std::map<std::string, std::string> texts;
  if (const TechniqueEntry* entry = catalog_.technique(target.technique))
    for (const ParameterGroup& group : entry->groups)
      if (group.id == entry->id)
        for (const ParamInfo& p : group.infos) texts[p.key()] = defaultText(p);
  for (const auto& [key, text] : ofGroup(target.parameters, target.technique)) texts[key] = text;
  link_.setTechnique(target.technique, texts);
}

void Document::apply(const Preset& wanted, bool whole) {
  Preset target = wanted;
  const Preset old = preset_;
  ++edits_;
  if (whole) {
    preset_ = target;
    sceneLights_.reset();
    pending_.drop();
    link_.load(target);
    announceAll();
    return;
  }
  target.camera = old.camera, target.cameraName = old.cameraName, target.file = old.file, target.animation = old.animation;
  const bool anotherTechnique = target.technique != old.technique;
  preset_ = target;
  if (anotherTechnique) pending_.make();  // it is rebuilt in any case
  const bool probes = target.probes != old.probes;
  const auto placementOf = [](const Preset& p) {
    const auto at = p.parameters.find(kPlacementKey);
    return at == p.parameters.end() ? std::string() : at->second;
  };
  const bool probesCount = placementOf(target) == kByHand || placementOf(old) == kByHand || pending_.waits(kPlacementKey);
  if (probes && probesCount && !anotherTechnique)
    pending_.keepProbes(old.probes, target.probes);
  else if (probes)
    link_.setProbes(target.probes);  // before the parameter that asks for them
  if (anotherTechnique) sendTechnique(target);
  std::map<std::string, std::string> keys = old.parameters;
  keys.insert(target.parameters.begin(), target.parameters.end());
  for (const auto& [key, unused] : keys) {
    const auto before = old.parameters.find(key);
    const auto after = target.parameters.find(key);
    const bool same = before != old.parameters.end() && after != target.parameters.end() && before->second == after->second;
    const bool own = key.rfind(target.technique + ".", 0) == 0;
    const ParamInfo* info = catalog_.parameter(target.technique, key);
    if (same || !info || (anotherTechnique && own)) continue;
    const std::string text = after != target.parameters.end() ? after->second : defaultText(*info);
    if (info->effect == Effect::Rebuild && !anotherTechnique)
      pending_.keep(key, before != old.parameters.end() ? before->second : defaultText(*info), text);
    else
      link_.setParam(key, text);
  }
  if (target.width != old.width || target.height != old.height) link_.setResolution(target.width, target.height);
  if (target.seed != old.seed) link_.setSeed(target.seed);
  const bool lights = lightsText(target.lights) != lightsText(old.lights);
  if (lights) sendLights(target.lights);
  const bool regions = target.regions != old.regions;
  if (regions) link_.setRegions(target.regions);
  const bool display = anotherTechnique || !(target.display == old.display);
  if (display) link_.setDisplay(target.display);
  if (anotherTechnique) emit techniqueChanged();
  if (display) emit displayChanged();
  if (regions) emit regionsChanged();
  if (probes) emit probesChanged();
  emit presetChanged();
  updateModified();
  pending_.ask();
}

void Document::open(const QString& path) {
  ++opening_;
  ++edits_;
  link_.open(path);
}

void Document::openScene(const QString& nameOrPath) {
  ++opening_;
  ++edits_;
  link_.openScene(nameOrPath);
}

void Document::onOpened(const Preset& preset, const QString& from) {
  opening_ = std::max(0, opening_ - 1);
  const bool isFile = !preset.file.empty();
  QStringList warnings;
  for (const std::string& w : preset.warnings) warnings << QString::fromStdString(w);
  pending_.drop();
  Preset before = std::exchange(preset_, preset);
  preset_.warnings.clear();
  if (warnings.isEmpty())
    partlyRead_.erase(preset_.file);
  else if (isFile)
    partlyRead_.insert(preset_.file);
  otherTechniques_.clear();
  sceneLights_.reset();
  if (first_)
    undo_.clear();
  else
    undo_.push(PresetCommand::opened(*this, before, preset_, tr("open %1").arg(from)));
  if (isFile || first_) saved_ = savedForm();
  first_ = false;
  announceAll();
  emit openedFile(from, warnings);
}

void Document::onPresetIs(const Preset& preset, quint64 ticket) {
  if (ticket != edits_) return;  // edited since: a later answer will tell
  const std::filesystem::path file = preset_.file;
  const std::map<std::string, std::string> wanted = pending_.parametersWanted();
  const auto probes = pending_.probesNow() ? std::optional(preset_.probes) : std::nullopt;
  preset_ = preset;
  preset_.file = file;
  for (const auto& [key, text] : wanted) preset_.parameters[key] = text;  // still waits
  if (probes) preset_.probes = *probes;
  announceAll();
}

void Document::onFrame() {
  const auto frame = link_.latest();
  if (!frame || !frame->scene || frame->scene == scene_) return;
  const bool another = !scene_ || scene_->hash != frame->scene->hash || scene_->source != frame->scene->source;
  scene_ = frame->scene;
  if (another) sceneRegions_.clear(), sceneProbes_.clear();
  if (!frame->preset.regions && frame->preset.scene == preset_.scene) sceneRegions_ = scene_->regions;
  if (!frame->preset.probes && frame->preset.scene == preset_.scene) sceneProbes_ = scene_->probes;
  if (!frame->preset.lights && frame->preset.scene == preset_.scene) sceneLights_ = lightsOf(*scene_);
  emit sceneChanged();
  emit regionsChanged();
  emit probesChanged();
  if (another) emit cameraChanged(true);
}

void Document::announceAll() {
  emit techniqueChanged();
  emit displayChanged();
  emit regionsChanged();
  emit probesChanged();
  emit presetChanged();
  emit cameraChanged(true);
  updateModified();
}

void Document::save(const QString& path) {
  preset_.file = path.toStdString();
  partlyRead_.erase(preset_.file);
  saving_ = savedForm();
  link_.savePreset(preset_, path);
  emit presetChanged();
}

void Document::sendAll() {
  ++edits_;
  pending_.drop();
  link_.load(preset_);
}

std::string Document::savedForm() const { return presetJson(preset_); }

void Document::updateModified() {
  const bool now = savedForm() != saved_;
  if (now != modified_) {
    modified_ = now;
    emit modifiedChanged(now);
  }
}

}  // namespace hl::ui
