// What a person can change, checked before anything is touched.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>

#include "engine/core/log.h"
#include "engine/scene/animation.h"
#include "engine/scene/scene_bundle.h"
#include "engine/scene/scene_file.h"
#include "engine/session/presenter.h"
#include "engine/session/probe_views.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

constexpr float kDefaultSliceMs = 30;
constexpr int kCalmFrames = 10;  // that the picture must be shown the same way before its errors are measured anew
constexpr int kMinResolution = 1, kMaxResolution = 8192;
// A vertex normal counts as smooth when it leaves its triangle's normal by more than about 0.8 degrees.
constexpr float kSmoothCosine = 0.9999f;

bool hasSmoothNormals(const Scene& scene) {
  for (const uvec3& t : scene.indices) {
    const vec3 n = glm::cross(scene.positions[t.y] - scene.positions[t.x], scene.positions[t.z] - scene.positions[t.x]);
    const float length = glm::length(n);
    if (!(length > 0)) continue;
    for (const uint32_t v : {t.x, t.y, t.z})
      if (glm::dot(n, scene.normals[v]) < kSmoothCosine * length) return true;
  }
  return false;
}

/// Everything about a scene that panels show; without the arrays that make it large. Lights as a person edits them, whatever moves them now.
std::shared_ptr<const Scene> summaryOf(const Scene& scene, const ScenePose& pose) {
  auto out = std::make_shared<Scene>();
  out->name = scene.name, out->source = scene.source, out->hash = scene.hash;
  out->objects = scene.objects, out->materials = scene.materials, out->hasUvs = scene.hasUvs;
  pose.restLights(*out);
  out->environment.file = scene.environment.file, out->environment.rotation = scene.environment.rotation;
  out->sky = scene.sky, out->cameras = scene.cameras, out->regions = scene.regions, out->probes = scene.probes;
  out->animations = scene.animations, out->lightAnimations = scene.lightAnimations, out->cameraPaths = scene.cameraPaths;
  out->bounds = scene.bounds, out->report = scene.report;
  return out;
}

void checkResolution(int width, int height) {
  if (width < kMinResolution || height < kMinResolution || width > kMaxResolution || height > kMaxResolution)
    throw badInput(fmt::format("resolution {}x{}: each side must be from {} to {} pixels", width, height, kMinResolution, kMaxResolution));
}

const Camera* findCamera(const Scene& scene, const std::string& name) {
  for (const Camera& c : scene.cameras)
    if (c.name == name) return &c;
  return nullptr;
}

void applyLights(Scene& scene, const LightEdits& lights) {
  scene.pointLights = lights.points;
  scene.spotLights = lights.spots;
  scene.directionalLights = lights.directionals;
  scene.sky = lights.sky;
}

void checkView(const std::string& view, const Technique& technique) {
  std::vector<std::string> ids;
  for (const ViewInfo& v : displayViews()) ids.push_back(v.id);
  for (const DebugView& v : technique.debugViews()) ids.push_back(v.id);
  if (technique.needs().probes)
    for (const ViewInfo& v : probeViews()) ids.push_back(v.id);
  for (const std::string& id : ids)
    if (id == view) return;
  throw badInput(fmt::format("view '{}': there is none of that name; there are {}", view, fmt::join(ids, ", ")));
}

}  // namespace

void checkCamera(const Scene& scene, const std::string& name) {
  if (name.empty() || findCamera(scene, name)) return;
  std::vector<std::string> names;
  for (const Camera& c : scene.cameras) names.push_back(c.name);
  const std::string guess = nearest(name, names);
  throw badInput(fmt::format("camera '{}': the scene '{}' has no such camera{}", name, scene.name,
                             guess.empty() ? fmt::format("; it has {}", fmt::join(names, ", ")) : fmt::format(", did you mean '{}'?", guess)));
}

Session::Impl::Impl(const SessionOptions& o) : options(o), device(o.device), shaders(device), presenter(std::make_shared<Presenter>(device)), graph(device, shaders), rates(device.info().name + " " + device.info().driver) {}
/// The window may hold on to the presenter; the device is ours.
Session::Impl::~Impl() { presenter->end(); }

Session::Session(const SessionOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Session::~Session() {
  for (ReferenceRun* run : {&impl_->full, &impl_->matched, &impl_->lightmapRun}) run->drop();
}
std::shared_ptr<Presenter> Session::presenter() const { return impl_->presenter; }
void Session::tellRebuilds(std::function<void(const RebuildForecast&)> told) { impl_->onRebuild = std::move(told); }
void Session::useProgress(std::shared_ptr<Progress> progress) { impl_->progress = std::move(progress); }

void Session::Impl::summarise() { summary = summaryOf(*scene, pose); }

void Session::Impl::collectParams() {
  params = ParamSet();
  params.add(technique->params());
  params.add(lightmapView(lightmap));
  params.add(probesView(probes));
  params.add(directView(direct));
  params.add(referenceView(reference));
}

std::map<std::string, std::string> Session::Impl::changedParams() const {
  std::map<std::string, std::string> out;
  for (const ParamView& group : params.views())
    for (const ParamInfo& info : group.infos()) {
      if (!group.isDefault(info)) out[info.key()] = formatParam(info, group.get(info));
    }
  return out;
}

Camera Session::Impl::camera() const {
  if (!preset.animation.cameraPath.empty()) return cameraAt(cameraPath(*scene, preset.animation.cameraPath), time);
  if (preset.camera) return *preset.camera;
  if (const Camera* c = findCamera(*scene, preset.cameraName)) return *c;
  return scene->cameras.front();
}

float Session::Impl::sliceMs() {
  const std::string key = preset.technique + ".slice_ms";
  if (!params.contains(key)) return kDefaultSliceMs;
  const ParamSet::Found found = params.find(key);
  const ParamValue v = found.view->get(*found.info);
  return std::holds_alternative<float>(v) ? std::get<float>(v) : static_cast<float>(std::get<int32_t>(v));
}

void Session::Impl::want(Effect effect) {
  if (effect == Effect::Rebuild) techniqueStale = true;
  if (effect != Effect::Live) resetWanted = true, held = false;  // what was cancelled or failed is not tried again for an exposure's sake
  measuredSettled = false;
}

/// The camera, a light or the geometry is not what it was in the last frame.
void Session::Impl::changed(Change change) {
  (change == Change::Camera ? cameraMoved : change == Change::Lights ? lightsMoved : geometryMoved) = true;
  measuredSettled = false;
  // A camera asks nothing of a technique that does not converge over frames: its picture is another one at once.
  if (change != Change::Camera || technique->framesToSettle() > 0) measureAnew = true;
  if (!technique->follows(change)) want(Effect::Reset);
}

void Session::Impl::referenceStale() {
  cameraChanged();
  lightmapRun.drop();
}

/// Pixels see other points now: what was measured on them no longer holds; the lightmap's own truth does.
void Session::Impl::cameraChanged() {
  full.drop(), matched.drop();
  referenceMs = 0;
  referenceStopped = measuredSettled = false;
  errors.clear();
}

/// Makes the scene the current one. The expensive parts that can fail are built first.
void Session::Impl::install(std::shared_ptr<Scene> next, Progress& p) {
  auto nextEmbree = std::make_shared<EmbreeScene>(*next, &p);
  GpuScene nextGpu = uploadScene(device, *next);
  auto nextTracer = makeTracer(options.tracer, device, shaders, *next, nextGpu, nextEmbree, pool, &p);
  device.waitIdle();
  view.reset();
  technique.reset();  // refers to the old scene
  directLight.reset();
  referenceStale();   // likewise
  tracer = std::move(nextTracer);
  gpuScene = std::move(nextGpu);
  embree = std::move(nextEmbree);
  scene = std::move(next);
  pose = ScenePose(*scene);
  clockFrame = 0;
  embreeStale = geometryMissed = lightsMissed = false;
  features = sceneFeatures(*scene);
  smoothNormals = hasSmoothNormals(*scene);
  summarise();
  directLight = std::make_unique<DirectLight>(device, shaders, gpuScene, *tracer);
  atlas.reset();
  placed.reset();
  candidate.reset();
  measuredTraceRate = 0;
  pickedProbe.reset();
  cornerUvs = {};
  pickPixel.reset();
  previousCamera.reset();
  atlasStale = probesStale = techniqueStale = resetWanted = true;
}

void Session::Impl::makeTechnique(const std::string& id) {
  auto next = techniqueInfo(id).create();
  view.reset();
  technique = std::move(next);
  preset.technique = id;
  collectParams();
  techniqueStale = resetWanted = true;
  held = false;
}

void Session::load(const Preset& preset, Progress* progress, const std::shared_ptr<const Scene>& loaded) {
  Impl& s = *impl_;
  Progress& p = progress ? *progress : *impl_->progress;
  checkResolution(preset.width, preset.height);
  // Checked on fresh groups first, so that a bad key or value leaves the session as it was.
  auto technique = techniqueInfo(preset.technique).create();
  LightmapParams lightmap;
  ProbesParams probes;
  DirectParams direct;
  ReferenceParams reference;
  ParamSet set;
  set.add(technique->params());
  set.add(lightmapView(lightmap));
  set.add(probesView(probes));
  set.add(directView(direct));
  set.add(referenceView(reference));
  for (const auto& [key, text] : preset.parameters) {
    const ParamSet::Found found = set.find(key);
    found.view->set(*found.info, parseParam(*found.info, text));
  }
  checkView(preset.display.view, *technique);
  const std::filesystem::path beside = isBundleFile(preset.file) ? preset.file : preset.file.parent_path();
  auto scene = std::make_shared<Scene>(loaded ? *loaded : loadScene(preset.scene, &p, beside));
  if (!preset.camera) checkCamera(*scene, preset.cameraName);
  checkPlayback(*scene, preset.animation);
  if (preset.lights) applyLights(*scene, *preset.lights);
  const std::vector<Region> ownRegions = scene->regions;
  if (preset.regions) {
    checkRegions(*preset.regions);
    scene->regions = *preset.regions;
  }
  const std::vector<vec3> ownProbes = scene->probes;
  if (preset.probes) {
    checkProbes(*preset.probes);
    scene->probes = *preset.probes;
  }

  s.install(std::move(scene), p);
  s.sceneRegions = ownRegions;
  s.sceneProbes = ownProbes;
  s.preset = preset;
  s.preset.warnings.clear();
  s.otherTechniques.clear();
  s.technique = std::move(technique);
  s.lightmap = lightmap;
  s.probes = probes;
  s.direct = direct;
  s.reference = reference;
  s.collectParams();
  s.held = false;
  s.workStopped = false;
  s.message = fmt::format("{}", fmt::join(preset.warnings, "; "));
  s.frameProfiler.clear();
  s.workProfiler.clear();
}

void Session::setScene(const std::string& nameOrPath, Progress* progress) {
  Preset next = preset();
  next.scene = nameOrPath;
  next.cameraName.clear();
  next.camera.reset();
  next.lights.reset();
  next.regions.reset();
  next.probes.reset();
  next.animation = {};
  const std::map<std::string, std::map<std::string, std::string>> others = impl_->otherTechniques;
  load(next, progress);
  impl_->otherTechniques = others;
}

void Session::setTechnique(const std::string& id) {
  Impl& s = *impl_;
  techniqueInfo(id);  // throws for an unknown one
  if (id == s.preset.technique) return;
  std::map<std::string, std::string> own;
  for (const auto& [key, text] : s.changedParams())
    if (key.rfind(s.preset.technique + ".", 0) == 0) own[key] = text;
  s.otherTechniques[s.preset.technique] = own;
  s.device.waitIdle();
  s.makeTechnique(id);
  for (const auto& [key, text] : s.otherTechniques[id]) {
    const ParamSet::Found found = s.params.find(key);
    found.view->set(*found.info, parseParam(*found.info, text));
  }
  s.matched.drop();
  s.lightmapRun.drop();
  s.frameProfiler.clear();
  s.workProfiler.clear();
  bool known = false;  // a view of the old technique has no place here
  for (const ViewInfo& v : displayViews()) known |= v.id == s.preset.display.view;
  if (!known) s.preset.display.view = "final";
}

void Session::setParam(const std::string& key, const std::string& text) {
  Impl& s = *impl_;
  const ParamSet::Found found = s.params.find(key);
  const ParamValue value = parseParam(*found.info, text);
  if (found.view->get(*found.info) == value) return;
  found.view->set(*found.info, value);
  if (found.info->group == "lightmap") s.atlasStale = true;
  if (found.info->group == "probes") {
    s.probesStale = true;
    if (!s.technique->needs().probes) return;  // nothing here depends on them
  }
  if (found.info->group == "reference") {
    // What was traced so far goes to the cache: a larger number of samples goes on from there.
    for (const ReferenceRun* run : {&s.full, &s.matched, &s.lightmapRun})
      if (run->tracer && run->result) run->tracer->store();
    s.referenceStale();
    return;
  }
  s.want(found.info->effect);
}

void Session::setCamera(const Camera& camera) {
  Impl& s = *impl_;
  const vec3 forward = camera.target - camera.position;
  if (!(glm::length(forward) > 0) || !(camera.verticalFov > 0) || !(camera.verticalFov < kPi))
    throw badInput("camera: it must look somewhere, with a field of view between 0 and 180 degrees");
  s.preset.camera = camera;
  s.preset.animation.cameraPath.clear();  // who takes hold of the camera leaves the path
  s.directLight->reset();
  s.cameraChanged();
  s.changed(Change::Camera);
}

void Session::setCameraName(const std::string& name) {
  Impl& s = *impl_;
  checkCamera(*s.scene, name);
  s.preset.cameraName = name;
  s.preset.camera.reset();
  s.preset.animation.cameraPath.clear();
  s.directLight->reset();
  s.cameraChanged();
  s.changed(Change::Camera);
}

void Session::setLights(const std::vector<PointLight>& points, const std::vector<SpotLight>& spots,
                        const std::vector<DirectionalLight>& directionals, vec3 sky) {
  Impl& s = *impl_;
  const LightEdits lights{points, spots, directionals, sky};
  Preset next = s.preset;
  next.lights = lights;
  presetHash(next);  // refuses what no preset can hold, Inf above all, before anything has changed
  applyLights(*s.scene, lights);
  s.preset = std::move(next);
  s.lightsChanged();
}

void Session::Impl::lightsChanged() {
  device.waitIdle();
  features = sceneFeatures(*scene);
  pose.setLights(*scene);
  updateLights(device, gpuScene, *scene);
  summarise();
  referenceStale();
  directLight->reset();
  held = false;  // as after every edit of the light: what was cancelled is tried again
  changed(Change::Lights);
}

void Session::setResolution(int width, int height) {
  checkResolution(width, height);
  Impl& s = *impl_;
  if (width == s.preset.width && height == s.preset.height) return;
  s.preset.width = width, s.preset.height = height;
  s.directLight->reset();
  s.cameraChanged();
  s.frameProfiler.clear();
}

void Session::setSeed(uint32_t seed) {
  impl_->preset.seed = seed;
  impl_->want(Effect::Rebuild);
}

void Session::setDisplay(const Display& display) {
  checkView(display.view, *impl_->technique);
  metricInfo(display.errorMetric);
  const Display& old = impl_->preset.display;
  // Errors of the picture are those of the picture as it is shown.
  if (display.exposure != old.exposure || display.toneMap != old.toneMap || display.errorMetric != old.errorMetric) impl_->framesToMeasure = kCalmFrames;
  impl_->preset.display = display;
}

void Session::pick(int x, int y) { impl_->pickPixel = {x, y}; }
void Session::setReferenceWanted(bool wanted) {
  impl_->referenceWanted = wanted;
  impl_->referenceStopped = false;
}
void Session::setImagesWanted(const std::vector<std::string>& names) {
  std::vector<std::string> known = impl_->imageNames();
  known.emplace_back("display");
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw badInput(fmt::format("image '{}': there is none of that name; there are {}", name, fmt::join(known, ", ")));
  impl_->imagesWanted = names;
}

void Session::setRegions(const std::optional<std::vector<Region>>& regions) {
  Impl& s = *impl_;
  if (regions) checkRegions(*regions);
  s.preset.regions = regions;
  s.scene->regions = regions ? *regions : s.sceneRegions;
  s.summarise();
  s.measuredSettled = false;
  s.lastMeasurementMs = -1e9;  // measured with the next frame
}

void Session::setProbes(const std::optional<std::vector<vec3>>& probes) {
  Impl& s = *impl_;
  if (probes) checkProbes(*probes);
  const std::vector<vec3>& next = probes ? *probes : s.sceneProbes;
  const bool changed = next != s.scene->probes;
  s.preset.probes = probes;
  if (!changed) return;
  s.scene->probes = next;
  s.summarise();
  if (s.probes.placement != kPlacementManual) return;
  s.probesStale = true;
  if (s.technique->needs().probes) s.want(Effect::Rebuild);
}

void Session::setWorkPaused(bool paused) { impl_->workPaused = paused; }

void Session::forgetTimes() { impl_->frameProfiler.forgetTimes(); }
void Session::cancelWork() {
  impl_->workStopped = true;
  impl_->referenceStopped = true;
}
void Session::restartWork() {
  impl_->workStopped = impl_->referenceStopped = impl_->held = false;
  impl_->message.clear();
}
ReloadReport Session::reloadShaders() {
  impl_->device.waitIdle();
  ReloadReport report = impl_->shaders.reload();
  if (!report.reloaded.empty()) {
    impl_->want(Effect::Reset);
    impl_->directLight->reset();
  }
  impl_->message = fmt::format("{}", fmt::join(report.errors, "; "));
  return report;
}
void Session::resetTechnique() { impl_->want(Effect::Reset); }

Preset Session::preset() const {
  Preset p = impl_->preset;
  p.parameters = impl_->changedParams();
  return p;
}
ParamSet& Session::params() { return impl_->params; }
const Scene& Session::scene() const { return *impl_->scene; }
const SceneFeatures& Session::features() const { return impl_->features; }
Device& Session::device() { return impl_->device; }
Technique& Session::technique() { return *impl_->technique; }
const PlacedProbes* Session::probes() const { return impl_->placed.get(); }
const Atlas* Session::atlas() const { return impl_->atlas ? &*impl_->atlas : nullptr; }
Transport Session::transport() const { return impl_->technique->transport(); }

}  // namespace hl
