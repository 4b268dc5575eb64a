// The scene's time: which moment a frame shows, and what that moves.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "engine/experiment/preset_names.h"
#include "engine/passes/pose.h"
#include "engine/scene/animation.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

/// Whether anything of it still lies ahead of a moment.
template <class Keys>
bool goesOn(const Keys& keys, Repeat repeat, double time) {
  return keys.size() > 1 && (repeat != Repeat::Once || time < static_cast<double>(keys.back().time));
}

void prepend(BatchTimings first, BatchTimings& timings) {
  first.passes.insert(first.passes.end(), timings.passes.begin(), timings.passes.end());
  timings.passes = std::move(first.passes);
  timings.wallMs += first.wallMs;
}

}  // namespace

void checkPlayback(const Scene& scene, const Playback& p) {
  if (!(p.start >= 0) || !(p.start <= kLongestAnimation))
    throw badInput(fmt::format("animation.start: {} s is out of range [0, {}]", p.start, kLongestAnimation));
  if (!(p.rate >= kLowestRate) || !(p.rate <= kHighestRate))
    throw badInput(fmt::format("animation.rate: {} frames a second is out of range [{}, {}]", p.rate, kLowestRate, kHighestRate));
  if (!p.cameraPath.empty()) cameraPath(scene, p.cameraPath);
}

void Session::setPlayback(const Playback& playback) {
  Impl& s = *impl_;
  if (!s.scene) load(Preset{}, nullptr);
  checkPlayback(*s.scene, playback);
  s.preset.animation = playback;
  s.clockFrame = 0;
  s.measuredSettled = false;
}

void Session::setCameraPaths(const std::vector<CameraPath>& paths) {
  Impl& s = *impl_;
  checkCameraPaths(paths);
  s.scene->cameraPaths = paths;
  const std::string& held = s.preset.animation.cameraPath;
  if (std::none_of(paths.begin(), paths.end(), [&](const CameraPath& p) { return p.name == held; })) s.preset.animation.cameraPath.clear();
  s.summarise();
}

void Session::setTime(double seconds) {
  Playback there = impl_->preset.animation;
  there.start = static_cast<float>(seconds);
  setPlayback(there);
}

/// Played, and not at an end that nothing comes after.
bool Session::Impl::timeRuns() const {
  if (!preset.animation.play) return false;
  const double now = static_cast<double>(preset.animation.start) + static_cast<double>(clockFrame) / static_cast<double>(preset.animation.rate);
  for (const ObjectAnimation& a : scene->animations)
    if (goesOn(a.keys, a.repeat, now)) return true;
  for (const LightAnimation& a : scene->lightAnimations)
    if (goesOn(a.keys, a.repeat, now)) return true;
  if (preset.animation.cameraPath.empty()) return false;
  const CameraPath& path = cameraPath(*scene, preset.animation.cameraPath);
  return goesOn(path.keys, path.repeat, now);
}

/// Brings everything to the moment that the next frame shows. A scene that nothing moves in passes through here without work.
void Session::Impl::moveToMoment() {
  momentTimings = {};
  time = static_cast<double>(preset.animation.start) + static_cast<double>(clockFrame) / static_cast<double>(preset.animation.rate);
  const ScenePose::Changed moved = pose.apply(*scene, time);
  if (moved.transforms) updateTransforms(device, gpuScene, pose.transforms());
  if (moved.lights) updateLights(device, gpuScene, *scene), features = sceneFeatures(*scene);
  if (moved.geometry) {
    updateEmitters(device, gpuScene, *scene);
    embreeStale = true;
    candidate.reset();
    recordPose(graph, gpuScene);
    tracer->recordUpdate(graph);
    momentTimings = graph.execute();
    if (tracer->onHost()) embreeStale = false;  // it is the one that the tracer has just updated
  }
  if (moved.geometry || moved.lights) {
    referenceStale();
    directLight->reset();
  }
  if (previousCamera && !camera().seesAs(*previousCamera) && !cameraMoved) {
    directLight->reset();
    cameraChanged();
    changed(Change::Camera);
  }
  // What a technique does not follow it is spared while the time runs.
  if (moved.lights) {
    lightsMoved = measureAnew = true;
    if (!technique->follows(Change::Lights)) lightsMissed = true;
  }
  if (moved.geometry) {
    geometryMoved = measureAnew = true;
    if (!technique->follows(Change::Geometry)) geometryMissed = true;
  }
  if (moved.geometry || moved.lights) measuredSettled = false;
  if (techniqueStale || (atlasStale && technique->needs().lightmap) || (probesStale && technique->needs().probes)) geometryMissed = false;  // it is about to be made anyway
  const bool still = !timeRuns() && !moved.geometry && !moved.lights;
  if (still && geometryMissed) atlasStale = probesStale = techniqueStale = true, held = false;
  if (still && (geometryMissed || lightsMissed)) want(Effect::Reset);
  if (still) geometryMissed = lightsMissed = false;
}

/// The rays of host and reference see the geometry of the moment. Where another tracer casts a technique's rays, only when they are asked for.
void Session::Impl::freshEmbree() {
  if (embreeStale) embree->update();
  embreeStale = false;
}

void Session::Impl::addMomentTimings(BatchTimings& timings) {
  if (momentTimings.passes.empty()) {
    if (!pose.movesGeometry()) return;
    PassTiming still;
    still.name = "scene: pose vertices", still.skipped = "nothing moved";
    timings.passes.insert(timings.passes.begin(), still);
    return;
  }
  prepend(std::move(momentTimings), timings);
  momentTimings = {};
}

std::string Session::Impl::momentNote() const {
  if (!geometryMissed && !lightsMissed) return "";
  return fmt::format("{}: what it shows belongs to {:.2f} s; it is made anew when the time stands still", preset.technique, madeAt);
}

}  // namespace hl
