// What a picture does over frames: flicker while nothing changes, and how it follows a step of the light or of a parameter.
#include <utility>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/metrics/temporal.h"
#include "engine/scene/animation.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

/// Of the settled picture: a technique that works every frame shows another noise in each.
constexpr size_t kSettledFrames = 16;

Image meanOf(const std::vector<Image>& images) {
  Image mean = images.front();
  for (size_t i = 0; i < mean.data.size(); ++i) {
    double sum = 0;
    for (const Image& image : images) sum += static_cast<double>(image.data[i]);
    mean.data[i] = static_cast<float>(sum / static_cast<double>(images.size()));
  }
  return mean;
}

struct Lights {
  std::vector<PointLight> points;
  std::vector<SpotLight> spots;
  std::vector<DirectionalLight> directionals;
  vec3 sky{0.0f};

  explicit Lights(const Scene& s) : points(s.pointLights), spots(s.spotLights), directionals(s.directionalLights), sky(s.sky) {}
  bool any() const { return !points.empty() || !spots.empty() || !directionals.empty() || sky != vec3(0); }
  Lights times(float factor) const {
    Lights out = *this;
    for (PointLight& l : out.points) l.intensity *= factor;
    for (SpotLight& l : out.spots) l.intensity *= factor;
    for (DirectionalLight& l : out.directionals) l.irradiance *= factor;
    out.sky *= factor;
    return out;
  }
  void applyTo(Session& session) const { session.setLights(points, spots, directionals, sky); }
};

}  // namespace

Step parseStep(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw badInput(fmt::format("step {}: lights=FACTOR, time=SECONDS, camera=NAME or KEY=VALUE is wanted, as in lights=0.5", text));
  Step step{text.substr(0, equals), text.substr(equals + 1)};
  if (!step.ofLights() && !step.ofTime()) return step;
  const auto end = std::from_chars(step.value.data(), step.value.data() + step.value.size(), step.factor);
  if (end.ec != std::errc() || end.ptr != step.value.data() + step.value.size() || !(step.factor >= 0) || !std::isfinite(step.factor) ||
      (step.ofLights() && step.factor == 1))
    throw badInput(step.ofLights() ? fmt::format("step {}: lights are multiplied by a number from 0 on, other than 1", text)
                                   : fmt::format("step {}: a time in seconds from 0 on is wanted", text));
  return step;
}

std::vector<ErrorValue> Session::measureFlicker(int frames, Progress* progress) {
  Impl& s = *impl_;
  Progress& p = progress ? *progress : *s.progress;
  if (frames < 2) throw badInput(fmt::format("flicker: at least two frames are wanted, not {}", frames));
  FlickerMeter meters[3];  // by Component
  const auto meter = [&](Component c) -> FlickerMeter& { return meters[static_cast<size_t>(c)]; };
  for (int i = 0; i < frames; ++i) {
    p.check();
    frame(&p);
    meter(Component::Indirect).add(s.indirectIrradiance());
    if (s.features.glossySurfaces) meter(Component::Specular).add(s.indirectSpecular());
    meter(Component::Final).add(s.device.download(s.finalImage));
  }
  std::vector<ErrorValue> out;
  const Mask glossy = s.features.glossySurfaces ? s.surfaceImages().glossy() : Mask{};
  for (const auto& [region, mask] : s.regionMasks(s.surfaceMask()))
    for (const Component c : {Component::Indirect, Component::Specular, Component::Final}) {
      Mask counts = mask;
      if (c == Component::Specular) {
        for (size_t i = 0; i < counts.size(); ++i) counts[i] = !glossy.empty() && mask[i] && glossy[i];
        if (!anySet(counts)) continue;
      }
      const FlickerResult r = meters[static_cast<size_t>(c)].result(counts);
      ErrorValue e;
      e.reference = "itself", e.target = "image", e.component = kComponentNames[static_cast<size_t>(c)], e.metric = "flicker", e.roi = region;
      e.value = r.value, e.nonFinite = r.nonFinite;
      e.noiseFloor = e.standardError = std::numeric_limits<double>::quiet_NaN();
      out.push_back(e);
    }
  return out;
}

void Session::checkStep(const Step& step) const {
  const Scene& scene = *impl_->scene;
  if (step.ofTime()) {
    Playback there = impl_->preset.animation;
    there.start = step.factor;
    checkPlayback(scene, there);
    if (!animated(scene)) throw badInput(fmt::format("step of the time: nothing in the scene '{}' is animated", scene.name));
  } else if (step.ofCamera()) {
    checkCamera(scene, step.value);
  } else if (!step.ofLights()) {
    parseParam(*impl_->params.find(step.key).info, step.value);
  } else if (!Lights(scene).any()) {
    throw badInput("step of the lights: the scene has none but surfaces that shine, and those cannot be edited");
  }
  if (impl_->timeRuns()) throw badInput("step: the scene's time runs, and nothing settles before or after it; let it stand still (animation.play false)");
}

StepReport Session::measureStep(const Step& step, int mostFrames, Progress* progress) {
  Impl& s = *impl_;
  Progress& p = progress ? *progress : *s.progress;
  checkStep(step);
  Scene atRest;
  s.pose.restLights(atRest);
  atRest.sky = s.scene->sky;
  const Lights lights(atRest);
  const struct Calm {  // slices of the reference would stretch the frames
    bool& wanted;
    const bool before = std::exchange(wanted, false);
    ~Calm() { wanted = before; }
  } calm{s.referenceWanted};
  std::string before;
  if (step.ofParameter()) {
    const ParamSet::Found found = s.params.find(step.key);
    before = formatParam(*found.info, found.view->get(*found.info));
  }
  const Playback playback = s.preset.animation;
  const Camera from = s.camera();
  const auto apply = [&](bool on) {
    if (step.ofLights()) return (on ? lights.times(step.factor) : lights).applyTo(*this);
    if (step.ofTime()) {
      Playback there = playback;
      there.play = false;
      if (on) there.start = step.factor;
      return setPlayback(there);
    }
    if (step.ofCamera()) return on ? setCameraName(step.value) : setCamera(from);
    setParam(step.key, on ? step.value : before);
  };
  // Both ends first, so that each frame is compared with where the picture will be and none has to be kept.
  apply(true);
  settle(&p);
  std::vector<Image> settled{s.indirectIrradiance()};
  while (settled.size() < kSettledFrames && s.technique->framesToSettle() > 0) frame(&p), settled.push_back(s.indirectIrradiance());
  const Image after = meanOf(settled);
  const Mask mask = s.surfaceMask();
  apply(false);
  // A cache that has been where the step leads would know the answer.
  if (s.technique->framesToSettle() > 0) resetTechnique();
  settle(&p);
  // A cut leaves no pixel as it was: what is left is measured against all of the settled picture.
  const Image now = step.ofCamera() ? Image(after.width, after.height, after.channels) : s.indirectIrradiance();
  apply(true);
  StepReport report;
  if (now.data == after.data) return report;
  TransientMeter meter(now, after, anySet(mask) ? mask : Mask());
  double squares = 0;
  for (const Image& image : settled) squares += meter.leftBy(image) * meter.leftBy(image);
  report.noise = std::sqrt(squares / static_cast<double>(settled.size()));
  std::vector<double> ms;
  const double start = nowMs();
  for (int i = 0; i < mostFrames; ++i) {
    p.check();
    const auto result = frame(&p);
    ms.push_back(nowMs() - start);
    meter.add(s.indirectIrradiance());
    report.settled = result->settled;
    if (report.settled) break;
  }
  const StepResponse r = meter.result();
  report.size = r.size, report.left = r.left, report.frames5 = r.frames5, report.frames1 = r.frames1;
  report.meanLeft = r.meanLeft, report.meanFrames5 = r.meanFrames5, report.meanFrames1 = r.meanFrames1;
  if (r.frames5) report.ms5 = ms[*r.frames5 - 1];
  if (r.frames1) report.ms1 = ms[*r.frames1 - 1];
  return report;
}

}  // namespace hl
