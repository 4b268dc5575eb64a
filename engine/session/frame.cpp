// One frame: prepare what edits made stale, record the passes, execute, publish.
#include <fmt/core.h>

#include <algorithm>

#include "engine/core/log.h"
#include "engine/scene/animation.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

// A statistic over fewer frames says little; over more, it costs the person's time (MEASURES.md section 4).
constexpr uint64_t kTimedFrames = 30, kLeastTimedFrames = 5;
constexpr double kTimingBudgetMs = 60e3;
// How much of a slice goes to the reference once the technique has settled.
constexpr double kReferenceSliceMs = 60;
constexpr double kMeasureEveryMs = 2000;
// What measuring takes is at most this share of the time.
constexpr double kMeasureShare = 0.1;

/// What is measured while things change: those that see a pixel's neighbours take longer, and wait for the end or for being looked at.
std::vector<std::string> liveMetrics(bool settled, const Display& display) {
  std::vector<std::string> out;
  for (const MetricInfo& m : metricInfos())
    if (m.id == display.errorMetric || !m.windowed || (settled && !m.costly)) out.emplace_back(m.id);
  return out;
}

PickedPoint pickedPoint(Device& device, const GBuffer& g, int x, int y) {
  PickedPoint p;
  p.x = x, p.y = y;
  if (x < 0 || y < 0 || x >= g.width || y >= g.height) return p;
  const Image position = device.download(g.position), normal = device.download(g.normal), geometric = device.download(g.geometricNormal);
  const float* a = position.pixel(x, y);
  if (a[3] == 0) return p;
  const float* n = geometric.pixel(x, y);
  std::vector<uint32_t> ids(position.pixels() * 2);
  device.download(g.ids, ids.data(), ids.size() * sizeof(uint32_t));
  p.position = vec3(a[0], a[1], a[2]);
  p.normal = vec3(n[0], n[1], n[2]);
  p.lightmapUv = vec2(normal.pixel(x, y)[3], n[3]);
  p.triangle = ids[(static_cast<size_t>(y) * static_cast<size_t>(g.width) + static_cast<size_t>(x)) * 2] - 1;
  return p;
}

}  // namespace

/// A history of its own each time, since published frames share the last. Every second point goes when there are many: the plot is logarithmic or coarse.
void Session::Impl::addConvergencePoint() {
  constexpr size_t kMostPoints = 512;
  auto next = std::make_shared<std::vector<ConvergencePoint>>(*convergence);
  if (next->size() >= kMostPoints) {
    size_t kept = 0;
    for (size_t i = 0; i < next->size(); i += 2) (*next)[kept++] = std::move((*next)[i]);
    next->resize(kept);
  }
  next->push_back({frameSinceChange, msSinceReset, shownMs(lastTimings.wallMs), errors});
  convergence = std::move(next);
}

std::shared_ptr<const FrameResult> Session::frame(Progress* progress) {
  Impl& s = *impl_;
  Progress& p = progress ? *progress : *impl_->progress;
  if (!s.scene) load(Preset{}, &p);
  s.prepare(p);

  const int width = s.preset.width, height = s.preset.height;
  const bool hasSurfaces = s.features.surfaces;
  s.gbuffer = recordGBuffer(s.graph, s.gpuScene, s.cornerUvs, s.camera(), width, height);
  const Camera camera = s.camera(), previousCamera = s.previousCamera.value_or(camera);
  if (s.motionWanted()) recordMotion(s.graph, s.gbuffer, s.gpuScene, camera, previousCamera);
  s.directImage = s.directLight->recordPixels(s.graph, s.gbuffer, s.direct, s.preset.seed);
  s.directSpecularImage = s.directLight->recordSpecular(s.graph, s.gbuffer, camera.position, s.direct, s.preset.seed);
  s.indirectImage = s.specularImage = {};
  if (s.held || s.techniqueStale) {
    s.graph.skip(s.preset.technique, "its preparation was cancelled or failed");
  } else if (!hasSurfaces || !s.features.anyLight()) {
    s.graph.skip(s.preset.technique, hasSurfaces ? "the scene has no lights" : "the scene has no surfaces");
  } else {
    const IndirectLight light = s.technique->record(s.graph, {s.gbuffer, s.frameSinceReset, s.preset.seed, s.preset.display.view, camera, previousCamera, s.time,
                                                              s.previousTime, s.frameSinceChange, s.cameraMoved, s.lightsMoved, s.geometryMoved});
    s.indirectImage = light.irradiance, s.specularImage = light.specular;
  }
  s.finalImage = recordComposite(s.graph, s.gbuffer, s.directImage, s.indirectImage, s.scene->sky, s.specularImage, s.directSpecularImage);
  recordBackground(s.graph, s.gbuffer, s.gpuScene, camera, s.finalImage);

  GpuImage source = s.finalImage;
  bool sceneReferred = true;
  const std::string& viewId = s.preset.display.view;
  if (viewId == "indirect_irradiance" && s.indirectImage) source = s.indirectImage;
  if (viewId == "direct") source = s.directImage;
  if (viewId == "albedo") source = s.gbuffer.albedo, sceneReferred = false;
  if (viewId == "normal") source = s.gbuffer.normal, sceneReferred = false;
  if (viewId == "position") source = s.gbuffer.position, sceneReferred = false;
  if (viewId == "emission") source = s.gbuffer.emission;
  if (viewId == "motion") source = s.gbuffer.motion, sceneReferred = false;
  if (viewId == "indirect") source = recordComposite(s.graph, s.gbuffer, GpuImage(), s.indirectImage, vec3(0), s.specularImage);
  if (viewId == "specular") source = s.specularImage;
  if (viewId == "direct_specular") source = s.directSpecularImage;
  if (!s.held)
    for (const DebugView& v : s.technique->debugViews())
      if (v.id == viewId && v.image) source = v.image, sceneReferred = v.irradiance;
  s.displayImage = recordToneMap(s.graph, source, s.preset.display, sceneReferred, width, height, s.displayCounters);
  BatchTimings timings = s.graph.execute();
  s.addMomentTimings(timings);
  s.serialisedTiming = timings.serialised;
  s.frameProfiler.add(timings);
  s.lastTimings = timings;
  s.msSinceReset += timings.wallMs;
  ++s.frameNumber;
  ++s.frameSinceReset;
  ++s.frameSinceChange;
  s.cameraMoved = s.lightsMoved = s.geometryMoved = false;
  s.previousCamera = camera;
  s.previousTime = s.time;
  uint32_t counters[2] = {0, 0};
  s.device.download(s.displayCounters, counters, sizeof counters);
  s.nonFinite = counters[0], s.negative = counters[1];

  if (s.pickPixel) {
    s.picked = pickedPoint(s.device, s.gbuffer, s.pickPixel->first, s.pickPixel->second);
    s.pickReport = s.held || s.techniqueStale ? PickReport{} : s.technique->pick(s.picked);
    s.pickProbe();
    s.pickPixel.reset();
  }
  const bool running = s.timeRuns();  // then a reference of this moment would be thrown away with the next frame
  if (s.referenceWanted && !s.referenceStopped && !running && !s.referencesStarted()) s.startReferences();
  bool worked = false;  // then this frame's picture is older than the state
  if (!s.workPaused) {
    try {
      if (!s.workSettled()) {
        worked = true;
        s.runWork(s.sliceMs(), p);
      } else if (s.referenceWanted && !s.referenceStopped && !running) {
        s.runReference(kReferenceSliceMs, p);
      }
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::Cancelled) throw;
      s.workStopped = s.referenceStopped = true;
      s.message = e.what();
    }
  }
  // Measured on a schedule, and once more at the end, so that a settled session shows the numbers of what it shows.
  const bool referencesDone = s.referencesSettled();
  // A frame that worked shows what was there before its work: it is not the last to be measured.
  const bool allSettled = !worked && !running && !s.geometryMissed && !s.lightsMissed && s.techniqueSettled() && s.directLight->settled(s.direct) && referencesDone;
  const bool due = s.msSinceReset + s.referenceMs - s.lastMeasurementMs > std::max(kMeasureEveryMs, s.measurementMs / kMeasureShare);
  const bool shownAnew = s.framesToMeasure > 0 && --s.framesToMeasure == 0;  // not while someone turns the exposure
  if (shownAnew) s.measuredSettled = false;
  if (s.referenceWanted && s.full.result && !s.measuredSettled && (due || allSettled) && !p.cancelled()) {
    const double began = nowMs();
    s.lastMeasurementMs = s.msSinceReset + s.referenceMs;
    s.measuredSettled = allSettled;
    s.errors = measureErrors(liveMetrics(allSettled, s.preset.display));
    s.addConvergencePoint();
    s.measurementMs = nowMs() - began;
  }

  auto result = std::make_shared<FrameResult>();
  FrameResult& r = *result;
  r.number = s.frameNumber;
  r.frame = s.frameSinceReset;
  r.width = width, r.height = height;
  r.time = s.time, r.playing = running, r.camera = camera;
  r.view = viewId;
  s.publishPicture(r);
  s.publishImages(r);
  r.frameTime = s.frameProfiler.frame();
  r.unaccounted = s.frameProfiler.unaccounted();
  if (s.settledFrames == 0 && !worked && !running && !s.resetWanted && !s.held && s.techniqueSettled())
    s.settledFrames = s.frameSinceChange, s.settledMs = s.shownMs(timings.wallMs);
  r.prepareMs = s.prepareMs, r.sinceResetMs = s.msSinceReset;
  r.settledFrames = s.settledFrames, r.settledMs = s.settledMs;
  r.workMs = s.workMs, r.workUnits = s.workUnitsTimed;
  r.passes = s.frameProfiler.passes();
  r.workPasses = s.workProfiler.passes();
  r.lastPasses = timings.passes;
  for (const auto& [name, bytes] : s.gpuScene.memory()) r.memory.push_back({"scene: " + name, bytes});
  for (const auto& [name, bytes] : s.tracer->memory()) r.memory.push_back({"tracer: " + name, bytes});
  for (const auto& [name, bytes] : s.directLight->memory()) r.memory.push_back({"direct: " + name, bytes});
  for (const MemoryItem& m : s.technique->memory()) r.memory.push_back({s.preset.technique + ": " + m.name, m.bytes});
  if (!s.held && !s.techniqueStale) r.bytesMoved = s.technique->bytesMoved();
  r.memory.push_back({"device: all blocks", s.device.bytesAllocated()});
  r.counters = {{"nan_inf", s.nonFinite}, {"negative", s.negative}};
  if (s.technique->needs().probes && s.placed) {
    r.counters.push_back({"probes", static_cast<double>(s.placed->count())});
    r.counters.push_back({"probes_inside_geometry", static_cast<double>(s.placed->insideGeometry)});
    r.counters.push_back({"probes_coverage", s.placed->coverage});
    if (s.atlas) r.counters.push_back({"probes_unseen_area", (1 - s.placed->coverage) * s.atlas->report.area});  // [m^2]
  }
  for (const auto& c : s.technique->counters()) r.counters.push_back(c);
  if (s.full.result) r.counters.push_back({"reference_back_face_hits", static_cast<double>(s.full.result->backFaceHits)});
  const WorkState work = s.held ? WorkState{} : s.technique->work();
  r.technique.running = !s.workSettled();
  r.technique.label = work.label;
  r.technique.done = work.total ? static_cast<double>(work.done) / static_cast<double>(work.total) : 1.0;
  const uint32_t settling = s.held || work.total ? 0 : s.technique->framesToSettle();
  if (settling > 0) {
    r.technique.done = std::min(1.0, static_cast<double>(s.frameSinceChange) / settling);
    if (!s.techniqueSettled()) r.technique.label = fmt::format("frame {} of {}", s.frameSinceChange, settling);
  }
  if (r.technique.running && s.workUnitsTimed)
    r.technique.secondsLeft = s.workMs / static_cast<double>(s.workUnitsTimed) * static_cast<double>(work.total - work.done) / 1000;
  if (s.full.tracer) {
    r.reference.label = animated(*s.scene) || !s.preset.animation.cameraPath.empty() ? fmt::format("reference at {:.2f} s", s.time) : "reference";
    const double all = s.matched.tracer ? 2 : 1;
    r.reference.done = (s.full.tracer->done() + (s.matched.tracer ? s.matched.tracer->done() : 0)) / all;
    r.reference.running = s.referenceWanted && !s.referenceStopped && !referencesDone;
    if (r.reference.running && r.reference.done > s.referenceStart + 1e-3)
      r.reference.secondsLeft = s.referenceMs / 1000 * (1 - r.reference.done) / (r.reference.done - s.referenceStart);
  }
  r.errors = s.errors;
  r.convergence = s.convergence;  // shared, not copied
  r.settled = !worked && !running && !s.geometryMissed && !s.lightsMissed && !s.resetWanted && s.techniqueSettled() && s.directLight->settled(s.direct) &&
              (!s.referenceWanted || s.referenceStopped || referencesDone);
  r.provenance = provenance();
  // Else what the picture had to say of itself.
  if (std::string note = s.message.empty() ? s.momentNote() : s.message; !note.empty()) r.message = std::move(note);
  r.techniqueFailed = s.held, r.failure = s.heldKind;
  r.pick = s.pickReport;
  r.picked = s.picked;
  r.scene = s.summary;
  r.features = s.features;
  r.triangles = s.scene->triangles();
  if (s.atlas) r.atlas = s.atlas->report;
  if (s.technique->needs().probes && s.placed) r.probes = s.placed, r.pickedProbe = s.pickedProbe;
  r.preset = preset();
  if (s.preset.animation.play) ++s.clockFrame;
  return result;
}

void Session::finishWork(Progress* progress, double limitMs) {
  Progress& p = progress ? *progress : *impl_->progress;
  Impl& s = *impl_;
  if (s.frameNumber == 0 || s.resetWanted || s.techniqueStale) frame(&p);
  while (!s.workSettled()) {
    p.check();
    s.runWorkWithin(limitMs, p);
  }
}

std::shared_ptr<const FrameResult> Session::settle(Progress* progress, double limitMs) {
  if (impl_->scene && impl_->timeRuns())
    throw badInput("a scene whose time runs never settles: say how many frames are wanted, or let it stand still (animation.play false)");
  Progress& p = progress ? *progress : *impl_->progress;
  Impl& s = *impl_;
  auto result = frame(&p);
  // Units are numbered, so that giving them all the time at once changes the pace and nothing else.
  while (!s.workSettled()) {
    p.check();
    s.runWorkWithin(limitMs, p);
    if (s.referenceWanted && s.full.result && !s.workSettled()) result = frame(&p);  // a point of the error over time
  }
  p.check();
  const double start = nowMs();
  do {
    p.check();
    if (!s.techniqueSettled()) s.checkLimit(limitMs);
    result = frame(&p);
  } while (!result->settled || s.frameProfiler.frames() < kLeastTimedFrames ||
           (s.frameProfiler.frames() < kTimedFrames && nowMs() - start < kTimingBudgetMs));
  return result;
}

}  // namespace hl
