// Errors of what is shown, against the full reference and against one limited to the paths the technique models.
#include <fmt/core.h>

#include "engine/session/session_impl.h"

namespace hl {
namespace {

/// Adds emission and multiplies irradiance by albedo / pi, as the composite pass does; where nothing is seen, the sky.
Image composite(const Image& direct, const Image& indirect, const Image& albedo, const Image& emission, const Image& position, vec3 sky) {
  Image out(direct.width, direct.height, 3);
  for (size_t i = 0; i < out.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const float e = direct.data[i * static_cast<size_t>(direct.channels) + c] + indirect.data[i * static_cast<size_t>(indirect.channels) + c];
      const bool surface = position.data[i * 4 + 3] != 0;
      out.data[i * 3 + c] = surface ? emission.data[i * 4 + c] + e * albedo.data[i * 4 + c] / kPi : sky[static_cast<int>(c)];
    }
  return out;
}

Mask surfaceMask(const Image& position) {
  Mask mask(position.pixels());
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = position.data[i * 4 + 3] != 0;
  return mask;
}

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
    for (const std::string& m : metrics)
      out.push_back(valueOf(measure(m, value, s.lightmapRun.result->indirectImage(bounces)), m, "matched", "lightmap", "indirect", ""));
    return out;
  }
  if (target != "image") throw badInput(fmt::format("error target '{}': it is image or lightmap", target));
  if (!s.full.result) return out;
  const Image position = s.device.download(s.gbuffer.position), albedo = s.device.download(s.gbuffer.albedo);
  const Image emission = s.device.download(s.gbuffer.emission), direct = s.device.download(s.directImage);
  const Image indirect = s.indirectImage ? s.device.download(s.indirectImage) : Image(position.width, position.height, 4);
  const Mask mask = surfaceMask(position);
  if (!anySet(mask)) return out;
  const Image final = composite(direct, indirect, albedo, emission, position, s.scene->sky);
  for (const bool matched : {true, false}) {
    const ReferenceRun& run = matched && s.matched.tracer ? s.matched : s.full;
    if (!run.result) continue;
    const char* name = matched ? "matched" : "full";
    const ReferenceImage truth = run.result->indirectImage(matched ? bounces : s.fullBounces());
    const ReferenceImage sun = run.result->directImage();
    const auto whole = [&](const Image& d, const Image& i) { return composite(d, i, albedo, emission, position, s.scene->sky); };
    const ReferenceImage truthFinal{whole(sun.mean, truth.mean), whole(sun.halfA, truth.halfA), whole(sun.halfB, truth.halfB)};
    for (const std::string& m : metrics) {
      out.push_back(valueOf(measure(m, indirect, truth, mask), m, name, "image", "indirect", ""));
      out.push_back(valueOf(measure(m, final, truthFinal, mask), m, name, "image", "final", ""));
      for (const Region& region : s.scene->regions) {
        const Mask part = within(mask, region, position.width, position.height);
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
  const Image position = s.device.download(s.gbuffer.position);
  const Image indirect = s.indirectImage ? s.device.download(s.indirectImage) : Image(position.width, position.height, 4);
  const Mask mask = surfaceMask(position);
  if (!anySet(mask)) return Image(position.width, position.height, 1);
  const ReferenceImage truth = run.result->indirectImage(matched ? s.technique->transport().bounces : s.fullBounces());
  return measure(metric, indirect, truth, mask, true).map;
}

}  // namespace hl
