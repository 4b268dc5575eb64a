// What a rebuild would take: placement and counts for the parameters in question, speeds from what was done before.
#include "engine/session/rebuild_forecast.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/passes/measured_rates.h"
#include "engine/session/session_impl.h"
#include "engine/trace/surface_rays.h"
#include "shaders/shared/ray.h"

namespace hl {
namespace {

constexpr double kWorthSaying = 0.95;  // [s]
constexpr double kFullCoverage = 0.6;  // of a lightmap, where nothing is known of it yet
/// What a ray takes beside its tracing, and sums a second, where neither has been done here before: within a factor of a few on what was tried (README.md).
constexpr double kRayOverhead = 1.6, kSumsASecond = 1e9;

/// A technique and groups of its own, with the session's parameters and then `changes`.
struct Candidate {
  std::unique_ptr<Technique> technique;
  LightmapParams lightmap;
  ProbesParams probes;
  DirectParams direct;
  ReferenceParams reference;
  ParamSet params;

  explicit Candidate(const std::string& id) : technique(techniqueInfo(id).create()) {
    params.add(technique->params());
    params.add(lightmapView(lightmap));
    params.add(probesView(probes));
    params.add(directView(direct));
    params.add(referenceView(reference));
  }
  void set(const std::string& key, const std::string& text) {
    const ParamSet::Found found = params.find(key);
    found.view->set(*found.info, parseParam(*found.info, text));
  }
};

std::string amountText(double n) {
  if (n >= 1e9) return fmt::format("{:.3g} G", n / 1e9);
  if (n >= 1e6) return fmt::format("{:.3g} M", n / 1e6);
  return n >= 1e3 ? fmt::format("{:.3g} k", n / 1e3) : fmt::format("{:.0f}", n);
}

std::string secondsText(double s) {
  if (s < kWorthSaying) return "less than a second";
  if (s < 90) return fmt::format("about {:.0f} s", s);
  return s < 5400 ? fmt::format("about {:.0f} min", s / 60) : fmt::format("about {:.1f} h", s / 3600);
}

std::string bytesText(double bytes) { return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9); }

}  // namespace

std::string forecastText(const RebuildForecast& f) {
  if (!f.refused.empty()) return f.refused;
  const std::string warnings = fmt::format("{}", fmt::join(f.warnings, "; "));
  if (f.seconds < 0) return warnings;
  std::string text = f.anew.empty() ? "" : fmt::format("{}: ", fmt::join(f.anew, ", "));
  text += f.work.atMost && f.seconds >= kWorthSaying ? "at most " + secondsText(f.seconds) : secondsText(f.seconds);
  if (f.basis == ForecastBasis::OtherScene) text += " (by another scene's speed)";
  if (f.basis == ForecastBasis::Calibrated) text += " (roughly: no such work was done here yet)";
  text += fmt::format("; {} rays, {}", amountText(f.work.rays), bytesText(f.work.bytes));
  if (f.work.bytesOfFrames > 0) text += fmt::format(" and {} for its frames", bytesText(f.work.bytesOfFrames));
  if (f.work.bytesMore > 0) text += fmt::format(" and at most {} more", bytesText(f.work.bytesMore));
  if (f.work.bytesBefore > 0) text += fmt::format(", {} before compression", bytesText(f.work.bytesBefore));
  return warnings.empty() ? text : text + "; " + warnings;
}

/// A tracer's speed is its own.
std::string Session::Impl::workName() const { return preset.technique + " by " + tracer->id(); }

/// [1e6 rays/s] from surfaces of this scene; measured once for each scene.
double Session::Impl::sceneTraceRate(Progress& p) {
  if (measuredTraceRate > 0) return measuredTraceRate;
  const uint32_t count = device.isCpu() ? 1u << 15 : 1u << 20;
  const std::vector<shared::Ray> rays = gatherRays(*scene, count, direct.ray_offset * gpuScene.diagonal);
  if (rays.empty()) return measuredTraceRate = 1;
  const Buffer from = device.buffer("forecast: rays", rays.size() * sizeof(shared::Ray), TexelFormat::RGBA32F);
  device.upload(from, rays.data(), rays.size() * sizeof(shared::Ray));
  const Buffer hits = device.buffer("forecast: hits", rays.size() * sizeof(shared::Hit));
  return measuredTraceRate = std::max(1e-6, hl::traceRate(device, graph, *tracer, from, hits, count, Query::Closest, p));
}

RebuildForecast Session::Impl::forecastOf(const Technique& asked, const SceneView& scene_, double lumels, bool atlasAnew, bool betweenFrames, Progress& p) {
  RebuildForecast f;
  f.rebuilds = true;
  try {
    f.work = asked.rebuildEstimate(device, scene_, lumels, p);
  } catch (const Error& e) {
    if (e.kind() == ErrorKind::Cancelled || e.kind() == ErrorKind::Device) throw;
    f.refused = e.what();
    return f;
  }
  if (f.work.parts.empty()) return f;
  f.anew = {f.work.name};
  double work = 0;
  for (const WorkPart& part : f.work.parts) {
    if (!(part.amount > 0)) continue;
    double ms = 0;
    if (const auto rate = rates.of(scene->hash, workName(), part.name)) {
      ms = rate->msPerAmount * part.amount;
      if (!rate->sameScene) f.basis = std::max(f.basis, ForecastBasis::OtherScene);
    } else {
      ms = part.kind == WorkPart::Kind::Rays ? kRayOverhead * part.amount / (1e3 * sceneTraceRate(p)) : 1e3 * part.amount / kSumsASecond;
      f.basis = ForecastBasis::Calibrated;
    }
    f.parts.push_back({part.name, ms / 1e3});
    work += ms;
  }
  // Frames are shown between slices of it.
  if (betweenFrames && work > 0) work *= 1 + frameProfiler.frame().medianMs / std::max(1.0, static_cast<double>(sliceMs()));
  double before = 0;
  if (atlasAnew && atlas) before += atlasMs * lumels / std::max(1.0, static_cast<double>(atlas->lumels.size()));
  if (const auto rate = rates.of(scene->hash, workName(), kAllocation)) before += rate->msPerAmount * lumels;
  f.parts.push_back({"preparation", before / 1e3});
  f.seconds = (before + work) / 1e3;
  return f;
}

RebuildForecast Session::forecastRebuild(const std::map<std::string, std::string>& changes, const std::optional<std::optional<std::vector<vec3>>>& manual, Progress* progress) {
  Impl& s = *impl_;
  Progress& p = progress ? *progress : *s.progress;
  if (!s.scene) return {};
  Candidate next(s.preset.technique);
  for (const auto& [key, text] : s.changedParams()) next.set(key, text);
  bool rebuild = false, atlasAnew = s.atlasStale, probesAnew = s.probesStale;
  const Technique::Needs needs = s.technique->needs();
  for (const auto& [key, text] : changes) {
    next.set(key, text);
    const ParamSet::Found now = s.params.find(key), then = next.params.find(key);
    if (now.view->get(*now.info) == then.view->get(*then.info)) continue;
    const bool lightmap = now.info->group == "lightmap", probes = now.info->group == "probes";
    if ((lightmap && !needs.lightmap) || (probes && !needs.probes)) continue;
    atlasAnew |= lightmap, probesAnew |= probes;
    rebuild |= now.info->effect == Effect::Rebuild;
  }
  RebuildForecast unknown;
  unknown.rebuilds = true;
  const auto refusal = [&](const Error& e) {
    if (e.kind() == ErrorKind::Cancelled || e.kind() == ErrorKind::Device) throw;
    unknown.refused = e.what();
    return unknown;
  };
  if (manual && *manual) {
    try {
      checkProbes(**manual);
    } catch (const Error& e) {
      return refusal(e);
    }
  }
  const std::vector<vec3>& ownProbes = manual ? (*manual ? **manual : s.sceneProbes) : s.scene->probes;
  if (ownProbes != s.scene->probes && needs.probes && next.probes.placement == kPlacementManual) rebuild = probesAnew = true;
  if (!rebuild) return {};

  if (!(s.features.surfaces && s.features.anyLight())) return unknown;
  const bool counts = !needs.lightmap || s.atlas;  // else nothing stands yet that could be counted: what is wrong with probes by hand is known all the same
  std::shared_ptr<const PlacedProbes> probes = s.placed;
  if (needs.probes && (probesAnew || !probes) && (counts || next.probes.placement == kPlacementManual)) {
    try {
      probes = s.placeCandidate(next.probes, ownProbes, p);
    } catch (const Error& e) {
      return refusal(e);
    }
  }
  if (needs.probes && probesAnew && probes) unknown.warnings = probes->warnings;
  if (!counts) return unknown;
  double lumels = s.atlas ? static_cast<double>(s.atlas->lumels.size()) : 0;
  if (atlasAnew && s.atlas) {
    const double side = next.lightmap.resolution, oldSide = s.atlas->resolution;
    if (next.lightmap.texels > 0) lumels = next.lightmap.texels;
    else lumels = lumels > 0 ? lumels * side * side / (oldSide * oldSide) : kFullCoverage * side * side;
  }
  const SceneView view{*s.scene, s.features, s.gpuScene, *s.tracer, *s.directLight, s.pool, needs.lightmap ? &*s.atlas : nullptr, next.lightmap, next.direct, s.preset.seed,
                       needs.probes ? probes.get() : nullptr};
  RebuildForecast forecast = s.forecastOf(*next.technique, view, lumels, atlasAnew, true, p);
  forecast.warnings = unknown.warnings;
  std::vector<std::string> before;
  if (atlasAnew && needs.lightmap) before.emplace_back("lightmap");
  if (probesAnew && needs.probes) before.emplace_back("placement");
  forecast.anew.insert(forecast.anew.begin(), before.begin(), before.end());
  p.begin("", 0);  // nothing of it goes on
  return forecast;
}

/// Probes as these parameters place them. What was found is kept: placeProbes() takes it, where these become the session's.
std::shared_ptr<const PlacedProbes> Session::Impl::placeCandidate(const ProbesParams& wanted, const std::vector<vec3>& manual, Progress& p) {
  freshEmbree();
  if (candidate && candidate->fits(wanted, manual, embree.get())) return candidate->placed;
  std::vector<vec3> kept = manual;
  std::swap(kept, scene->probes);  // placement reads them off the scene
  try {
    auto found = std::make_shared<const PlacedProbes>(hl::placeProbes(wanted, *scene, *embree, pool, p));
    std::swap(kept, scene->probes);
    candidate = {wanted, manual, embree, found};
    return found;
  } catch (...) {
    std::swap(kept, scene->probes);
    throw;
  }
}

bool Session::Impl::ProbeCandidate::fits(const ProbesParams& wanted, const std::vector<vec3>& hand, const EmbreeScene* embree_) const {
  ProbesParams a = params, b = wanted;
  const ParamView x = probesView(a), y = probesView(b);
  for (const ParamInfo& info : x.infos())
    if (!(x.get(info) == y.get(info))) return false;
  return manual == hand && embree.get() == embree_;
}

/// Of the work that has been done, once there is no more.
void Session::Impl::learnRates() {
  if (workPassMs.empty()) return;
  double passes = 0;
  for (const auto& [name, ms] : workPassMs) passes += ms;
  // What lies between passes is theirs as well.
  const double whole = passes > 0 ? std::max(1.0, workMs / passes) : 1;
  for (const WorkPart& part : technique->workDone()) {
    double ms = 0;
    for (const auto& [name, taken] : workPassMs)
      if (std::any_of(part.passes.begin(), part.passes.end(), [&n = name](const std::string& begin) { return n.starts_with(begin); })) ms += taken;
    rates.learn(scene->hash, workName(), part.name, part.amount, ms * whole);
  }
  workPassMs.clear();
  rates.store();
}

}  // namespace hl
