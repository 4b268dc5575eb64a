// Errors of what is shown, against the full reference and against one limited to the paths the technique models.
#include <fmt/core.h>

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
    for (const std::string& m : metrics)
      out.push_back(valueOf(measure(m, value, s.lightmapRun.result->indirectImage(bounces), byArea), m, "matched", "lightmap", "indirect", ""));
    return out;
  }
  if (target != "image") throw badInput(fmt::format("error target '{}': it is image or lightmap", target));
  if (!s.full.result) return out;
  const SurfaceImages surfaces = s.surfaceImages();
  const Image direct = s.device.download(s.directImage), indirect = s.indirectIrradiance();
  const Mask mask = surfaces.mask();
  if (!anySet(mask)) return out;
  const Image final = surfaces.composite(direct, indirect);
  for (const bool matched : {true, false}) {
    const ReferenceRun& run = matched && s.matched.tracer ? s.matched : s.full;
    if (!run.result) continue;
    const char* name = matched ? "matched" : "full";
    const ReferenceImage truth = run.result->indirectImage(matched ? bounces : s.fullBounces());
    const ReferenceImage sun = run.result->directImage();
    const ReferenceImage truthFinal{surfaces.composite(sun.mean, truth.mean), surfaces.composite(sun.halfA, truth.halfA),
                                    surfaces.composite(sun.halfB, truth.halfB)};
    for (const std::string& m : metrics) {
      out.push_back(valueOf(measure(m, indirect, truth, mask), m, name, "image", "indirect", ""));
      out.push_back(valueOf(measure(m, final, truthFinal, mask), m, name, "image", "final", ""));
      for (const Region& region : s.scene->regions) {
        const Mask part = within(mask, region, direct.width, direct.height);
        if (anySet(part)) out.push_back(valueOf(measure(m, indirect, truth, part), m, name, "image", "indirect", region.name));
      }
    }
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
  const Mask mask = s.surfaceImages().mask();
  if (!anySet(mask)) return Image(indirect.width, indirect.height, 1);
  const ReferenceImage truth = run.result->indirectImage(matched ? s.technique->transport().bounces : s.fullBounces());
  return measure(metric, indirect, truth, mask, true).map;
}

}  // namespace hl
