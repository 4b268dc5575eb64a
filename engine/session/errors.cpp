// Errors of what is shown, against the full reference and against one limited to the paths the technique models.
#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "engine/session/session_impl.h"

namespace hl {
namespace {

bool anySet(const Mask& mask) {
  for (const unsigned char m : mask)
    if (m) return true;
  return false;
}

ErrorValue valueOf(const MetricResult& m, const std::string& metric, const char* reference, const char* target, const char* component,
                   const std::string& roi) {
  ErrorValue e;
  e.reference = reference, e.target = target, e.component = component, e.metric = metric, e.roi = roi;
  e.value = m.value, e.noiseFloor = m.noiseFloor, e.standardError = m.standardError, e.nonFinite = m.nonFinite;
  return e;
}

Mask within(const Mask& mask, const Region& region, int width, int height) {
  Mask out(mask.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width), v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (u >= region.x && u < region.x + region.width && v >= region.y && v < region.y + region.height) out[i] = mask[i];
    }
  return out;
}

}  // namespace

std::vector<ErrorValue> Session::measureErrors(const std::vector<std::string>& metrics, const std::string& target) {
  Impl& s = *impl_;
  std::vector<ErrorValue> out;
  const int bounces = s.technique->transport().bounces;
  if (target == "lightmap") {
    const std::vector<vec3> lightmap = s.technique->lightmapIrradiance();
    if (!s.lightmapRun.result || lightmap.empty()) return out;
    Image value(static_cast<int>(lightmap.size()), 1, 3);
    for (size_t i = 0; i < lightmap.size(); ++i)
      for (size_t c = 0; c < 3; ++c) value.data[i * 3 + c] = lightmap[i][static_cast<int>(c)];
    MeasureOptions byArea;
    for (const Lumel& l : s.atlas->lumels) byArea.weights.push_back(l.area);
    const ReferenceImage truth = s.lightmapRun.result->indirectImage(bounces);
    for (const std::string& m : metrics)
      out.push_back(valueOf(measure(m, value, truth, byArea), m, "matched", "lightmap", "indirect", ""));
    return out;
  }
  if (target != "image") throw badInput(fmt::format("error target '{}': it is image or lightmap", target));
  if (!s.full.result) return out;
  return measureErrorsOf(s.indirectIrradiance(), metrics);
}

std::vector<ErrorValue> Session::measureErrorsOf(const Image& indirect, const std::vector<std::string>& metrics) {
  Impl& s = *impl_;
  std::vector<ErrorValue> out;
  const int bounces = s.technique->transport().bounces;
  if (!s.full.result) return out;
  const SurfaceImages surfaces = s.surfaceImages();
  const Image direct = s.device.download(s.directImage);
  const Mask mask = maskOf(surfaces.position);
  if (!anySet(mask)) return out;
  const Image final = surfaces.composite(direct, indirect);
  std::vector<Mask> parts;
  std::vector<std::string> regions;
  for (const Region& region : s.scene->regions) {
    Mask part = within(mask, region, direct.width, direct.height);
    if (anySet(part)) parts.push_back(std::move(part)), regions.push_back(region.name);
  }

  struct Truth {
    const char* reference;
    ReferenceImage indirect, final;
  };
  std::vector<Truth> truths;
  // One run serves both where they differ in bounces alone; beyond its buckets they do not differ at all.
  const bool same = !s.matched.tracer && std::min(bounces, kBounceBuckets) == std::min(s.fullBounces(), kBounceBuckets);
  for (const bool matched : {true, false}) {
    if (matched && !s.referencesStarted()) continue;  // the technique was changed since
    if (!matched && same && !truths.empty()) continue;
    const ReferenceRun& run = matched && s.matched.tracer ? s.matched : s.full;
    if (!run.result) continue;
    ReferenceImage truth = run.result->indirectImage(matched ? bounces : s.fullBounces());
    const ReferenceImage sun = run.result->directImage();
    ReferenceImage whole{surfaces.composite(sun.mean, truth.mean), surfaces.composite(sun.halfA, truth.halfA), surfaces.composite(sun.halfB, truth.halfB)};
    truths.push_back({matched ? "matched" : "full", std::move(truth), std::move(whole)});
  }

  struct Job {
    const Truth* truth;
    std::string metric, roi;
    const Mask* mask;
    bool final;
  };
  std::vector<Job> jobs;
  for (const Truth& truth : truths)
    for (const std::string& m : metrics) {
      jobs.push_back({&truth, m, "", &mask, false});
      jobs.push_back({&truth, m, "", &mask, true});
      for (size_t i = 0; i < parts.size(); ++i) jobs.push_back({&truth, m, regions[i], &parts[i], false});
    }
  out.resize(jobs.size());
  s.pool.parallelFor(jobs.size(), 1, [&](size_t first, size_t last, unsigned) {
    for (size_t i = first; i < last; ++i) {
      const Job& job = jobs[i];
      const MetricResult result = measure(job.metric, job.final ? final : indirect, job.final ? job.truth->final : job.truth->indirect, *job.mask);
      out[i] = valueOf(result, job.metric, job.truth->reference, "image", job.final ? "final" : "indirect", job.roi);
    }
  });
  if (same && truths.size() == 1 && truths[0].reference == std::string_view("matched")) {
    const size_t count = out.size();
    for (size_t i = 0; i < count; ++i) out.push_back(out[i]), out.back().reference = "full";
  }
  return out;
}

Image Session::errorMap(const std::string& metric, const std::string& reference) {
  Impl& s = *impl_;
  if (reference != "matched" && reference != "full") throw badInput(fmt::format("reference '{}': it is matched or full", reference));
  const bool matched = reference == "matched";
  const ReferenceRun& run = matched && s.matched.tracer ? s.matched : s.full;
  if (!run.result) throw badInput("error map: there is no reference yet");
  const Image indirect = s.indirectIrradiance();
  const Mask mask = s.surfaceMask();
  if (!anySet(mask)) return Image(indirect.width, indirect.height, 1);
  const ReferenceImage truth = run.result->indirectImage(matched ? s.technique->transport().bounces : s.fullBounces());
  return measure(metric, indirect, truth, mask, true).map;
}

}  // namespace hl
