// What takes longer than a frame: atlas, precomputation, bake, reference. In numbered units, between frames.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/lightmap/inside.h"
#include "engine/reference/receivers.h"
#include "engine/reference/reference_state.h"
#include "engine/session/run_limit.h"
#include "engine/session/session_impl.h"

namespace hl {
namespace {

// Less is traced again sooner than it is written.
constexpr double kWorthStoringMs = 5000;

}  // namespace

void ReferenceRun::start(const std::shared_ptr<const EmbreeScene>& embree, std::vector<Receiver> receivers, int width, int height, const ReferenceSettings& settings,
                         TaskPool& pool) {
  if (tracer) return;
  tracer = std::make_unique<ReferenceTracer>(embree, std::move(receivers), width, height, settings, pool);
  tracer->resume();
  result = tracer->result();
}

void ReferenceRun::advance(Progress& p) {
  const double began = nowMs();
  tracer->advance(p);
  ms += nowMs() - began;
  result = tracer->result();
  if (tracer->settled()) tracer->store();
}

void ReferenceRun::drop() {
  if (tracer && !tracer->settled() && result && ms > kWorthStoringMs) {
    try {
      tracer->store();
    } catch (const std::exception& e) {
      logWarning(fmt::format("the reference so far could not be stored: {}", e.what()));
    }
  }
  *this = {};
}

void Session::Impl::buildLightmap(Progress& p) {
  const double began = nowMs();
  freshEmbree();
  AtlasSettings settings;
  settings.resolution = lightmap.resolution;
  settings.uvOverlapTolerance = lightmap.uv_overlap_tolerance;
  settings.margin = lightmap.margin;
  const auto cast = [this](std::span<const shared::Ray> rays, std::span<shared::Hit> hits) { embree->closest(rays, hits); };
  const auto inside = insideTest(*scene, pool, kInsideRayOffset * scene->bounds.diagonal(), cast);
  if (lightmap.texels > 0) {
    // The side that gives the wanted number of valid texels, from the coverage found at a first guess.
    settings.resolution = std::clamp(static_cast<int>(std::ceil(std::sqrt(lightmap.texels / 0.6))), 32, 4096);
    for (int round = 0; round < 3; ++round) {
      Atlas trial = buildAtlas(*scene, settings, pool, p, inside);
      const double ratio = lightmap.texels / std::max(1.0, static_cast<double>(trial.lumels.size()));
      atlas = std::move(trial);
      const int next = std::clamp(static_cast<int>(std::lround(settings.resolution * std::sqrt(ratio))), 32, 4096);
      if (std::abs(ratio - 1) < 0.02 || next == settings.resolution) break;
      settings.resolution = next;
    }
  } else {
    atlas = buildAtlas(*scene, settings, pool, p, inside);
  }
  cornerUvs = device.buffer("lightmap: corner uvs", std::span<const vec2>(atlas->cornerUvs));
  atlasStale = false;
  techniqueStale = true;
  atlasMs = nowMs() - began;
  lightmapRun.drop();
}

void Session::Impl::placeProbes(Progress& p) {
  freshEmbree();
  placed = placeCandidate(probes, scene->probes, p);
  candidate.reset();
  for (const std::string& line : placed->warnings) logWarning(line);
  probesStale = false;
  pickedProbe.reset();
  techniqueStale = true;
}

void Session::Impl::prepare(Progress& p) {
  moveToMoment();
  if (!displayCounters) displayCounters = device.buffer("display: counters", 2 * sizeof(uint32_t));
  const bool renderable = features.surfaces && features.anyLight();
  const auto atlasWanted = [&] { return technique->needs().lightmap && (atlasStale || !atlas); };
  const auto probesWanted = [&] { return technique->needs().probes && (probesStale || !placed); };
  if (!held && renderable && (atlasWanted() || probesWanted() || techniqueStale)) {
    double began = nowMs();
    try {
      if (atlasWanted()) buildLightmap(p);
      if (probesWanted()) placeProbes(p);
      if (techniqueStale) {
        device.waitIdle();
        view.emplace(SceneView{*scene, features, gpuScene, *tracer, *directLight, pool,
                               technique->needs().lightmap ? &*atlas : nullptr, lightmap, direct, preset.seed,
                               technique->needs().probes ? placed.get() : nullptr});
        if (onRebuild) {
          const double paused = nowMs();
          const RebuildForecast forecast = forecastOf(*technique, *view, atlas ? static_cast<double>(atlas->lumels.size()) : 0, false, false, p);
          if (forecast.refused.empty() && forecast.seconds >= 0) onRebuild(forecast);
          began += nowMs() - paused;
        }
        Gpu gpu{device, shaders};
        const double allocation = nowMs();
        technique->rebuild(gpu, *view, p);
        if (!technique->work().settled()) rates.learn(scene->hash, workName(), kAllocation, atlas ? static_cast<double>(atlas->lumels.size()) : 0, nowMs() - allocation);
        madeAt = time;
        techniqueStale = false;
        resetWanted = true;
        workStopped = false;
      }
    } catch (const Error& e) {
      // The technique ends, not the program: direct light goes on, and restartWork() tries again.
      if (e.kind() == ErrorKind::Device) throw;
      held = true, heldKind = e.kind();
      message = e.what();  // for whoever drives the session to say
    } catch (const std::bad_alloc&) {
      held = true, heldKind = ErrorKind::Run;
      message = fmt::format("{}: out of memory", preset.technique);
    }
    prepareMs = nowMs() - began;
  }
  if (resetWanted) {
    if (!held && !techniqueStale) technique->reset();
    if (!geometryMissed) madeAt = time;
    directLight->reset();
    frameSinceReset = 0;
    workMs = 0, workUnitsTimed = 0;
    double done = 0;
    for (const WorkPart& part : technique->workDone()) done += part.amount;
    if (!(done > 0)) workPassMs.clear();  // else what was begun goes on
    workStopped = false;
  }
  if (resetWanted || measureAnew) {
    resetWanted = measureAnew = false;
    frameSinceChange = 0;
    msSinceReset = settledMs = 0;
    settledFrames = 0;
    convergence = std::make_shared<std::vector<ConvergencePoint>>();
    errors.clear();
    lastMeasurementMs = -1e9;
    measuredSettled = false;
    const Transport t = technique->transport();
    // Not its bounces: a run keeps them apart.
    const std::string key = fmt::format("{} {} {}", t.frontFacesOnly, static_cast<int>(t.receiver), t.glossyLastBounce);
    if (key != transportKey) matched.drop(), transportKey = key;
  }
}

bool Session::Impl::workSettled() const {
  return held || techniqueStale || workStopped || !features.surfaces || !features.anyLight() || technique->work().settled();
}

bool Session::Impl::techniqueSettled() const {
  const bool idle = held || techniqueStale || !features.surfaces || !features.anyLight();
  return workSettled() && (idle || frameSinceChange >= technique->framesToSettle());
}

void Session::Impl::runWork(double budgetMs, Progress& p) {
  const double start = nowMs();
  measuredSettled = false;
  do {
    technique->recordWork(graph);
    const BatchTimings t = graph.execute();
    if (!t.passes.empty()) workProfiler.add(t);  // a unit that only puts together what others made records none
    for (const PassTiming& pass : t.passes)
      if (pass.skipped.empty()) workPassMs[pass.name] += pass.ms;
    workMs += t.wallMs;
    msSinceReset += t.wallMs;
    ++workUnitsTimed;
    if (p.cancelled()) {
      workStopped = true;
      return;
    }
  } while (!workSettled() && nowMs() - start < budgetMs);
  if (technique->work().settled()) learnRates();
}

void Session::Impl::runWorkWithin(double limitMs, Progress& p) {
  constexpr double kSliceMs = 1000;
  checkLimit(limitMs);
  runWork(limitMs > 0 ? std::min(kSliceMs, limitMs - prepareMs - workMs) : kSliceMs, p);
}

void Session::Impl::checkLimit(double limitMs) const {
  const double used = prepareMs + (framesAreWork() ? msSinceReset : workMs);
  if (limitMs > 0 && used >= limitMs) throw LimitError(fmt::format("took {:.0f} ms and was not done; the limit is {:.0f} ms", used, limitMs));
}

bool Session::Impl::framesAreWork() const { return !held && !techniqueStale && technique->framesToSettle() > 0; }

double Session::Impl::shownMs(double frameMs) const { return framesAreWork() || !workUnitsTimed ? msSinceReset : workMs + frameMs; }

bool Session::Impl::referenceShared() const {
  const Transport t = technique->transport();
  const bool sameSides = !t.frontFacesOnly || !features.twoSided;
  const bool sameNormals = t.receiver == ReceiverNormal::Mapped || (!features.normalMaps && !smoothNormals);
  return sameSides && sameNormals;
}

ReferenceSettings Session::Impl::referenceSettings(bool matchedPaths) const {
  ReferenceSettings r;
  r.samplesPerPixel = reference.samples;
  r.seed = static_cast<uint64_t>(reference.seed);
  r.directSamples = reference.direct_samples;
  if (matchedPaths) {
    const Transport t = technique->transport();
    r.frontFacesOnly = t.frontFacesOnly;
    r.receiver = t.receiver;
    r.glossyLastBounce = t.glossyLastBounce;
  }
  return r;
}

std::vector<Receiver> Session::Impl::receivers() {
  std::vector<uint32_t> ids(static_cast<size_t>(gbuffer.width) * static_cast<size_t>(gbuffer.height) * 2);
  device.download(gbuffer.ids, ids.data(), ids.size() * sizeof(uint32_t));
  const vec3 eye = camera().position;
  return receiversFromGBuffer(device.download(gbuffer.position), device.download(gbuffer.normal), device.download(gbuffer.geometricNormal), ids,
                              scene.get(), &eye);
}

void Session::Impl::startReferences() {
  freshEmbree();
  const std::vector<Receiver> pixels = receivers();
  const auto start = [&](ReferenceRun& run, bool matchedPaths) {
    run.start(embree, pixels, gbuffer.width, gbuffer.height, referenceSettings(matchedPaths), pool);
  };
  start(full, false);
  if (!referenceShared()) start(matched, true);
  referenceMs = 0;
  referenceStart = full.tracer->done();
}

bool Session::Impl::referencesStarted() const { return full.tracer && (matched.tracer || referenceShared()); }

bool Session::Impl::referencesSettled() const {
  return full.tracer && full.tracer->settled() && (!matched.tracer || matched.tracer->settled());
}

void Session::Impl::runReference(double budgetMs, Progress& p) {
  const double start = nowMs();
  while (!referencesSettled() && nowMs() - start < budgetMs) {
    // The two advance together, so that both have something to show early.
    ReferenceRun& run = !matched.tracer || full.tracer->done() <= matched.tracer->done() ? (full.tracer->settled() ? matched : full) : matched;
    run.advance(p);
    measuredSettled = false;
  }
  referenceMs += nowMs() - start;
}

std::unique_ptr<ProgressiveTracer> Session::progressiveTracer(uint64_t seed) {
  Impl& s = *impl_;
  ReferenceSettings settings = s.referenceSettings(true);
  settings.seed = seed;
  settings.maxBounces = s.technique->transport().bounces;
  s.freshEmbree();
  return std::make_unique<ProgressiveTracer>(s.embree, s.receivers(), s.gbuffer.width, s.gbuffer.height, settings, s.pool);
}

unsigned Session::hostThreads() const { return impl_->pool.threads(); }

std::shared_ptr<const ReferenceResult> Session::currentReference() const { return impl_->full.result; }

std::vector<std::filesystem::path> Session::referenceFiles() const {
  std::vector<std::filesystem::path> files;
  for (const ReferenceRun* run : {&impl_->full, &impl_->matched, &impl_->lightmapRun})
    if (run->tracer && run->tracer->settled() && run->result)
      files.push_back(referenceCacheFile(run->result->key, static_cast<uint32_t>(run->result->samplesPerPixel) / 2));
  return files;
}

std::shared_ptr<const ReferenceResult> Session::reference(const std::string& target, Progress* progress) {
  Impl& s = *impl_;
  Progress& p = progress ? *progress : *impl_->progress;
  if (target != "image" && target != "lightmap") throw badInput(fmt::format("reference target '{}': it is image or lightmap", target));
  if (s.frameNumber == 0 || s.resetWanted) frame(&p);
  if (target == "image") {
    if (!s.referencesStarted()) s.startReferences();
    p.begin("reference", 1000);
    while (!s.referencesSettled()) {
      p.check();
      const double before = s.full.tracer->done();
      s.runReference(200, p);
      p.advance(static_cast<uint64_t>(1000 * (s.full.tracer->done() - before)));
    }
    return s.full.result;
  }
  if (!s.atlas)
    throw badInput(fmt::format("technique '{}' has no lightmap, so there is no lightmap reference", s.preset.technique));
  ReferenceRun& run = s.lightmapRun;
  s.freshEmbree();
  run.start(s.embree, receiversFromLumels(s.atlas->lumels), static_cast<int>(s.atlas->lumels.size()), 1, s.referenceSettings(true), s.pool);
  while (!run.tracer->settled()) {
    p.check();
    run.advance(p);
  }
  return run.result;
}

}  // namespace hl
