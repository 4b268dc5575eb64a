// What the probes hold, for reports: memory, counters, and the weights of those round a point that somebody picked.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/techniques/ddgi/probes.h"

namespace hl {
namespace {

uint64_t bytesOf(const GpuImage& image, uint64_t texel) { return texel * static_cast<uint64_t>(image.width()) * static_cast<uint64_t>(image.height()); }

const char* stateName(uint32_t state) {
  return state == shared::kProbeActive ? "active" : state == shared::kProbeInside ? "inside geometry" : "no surface near";
}

}  // namespace

std::vector<MemoryItem> DdgiProbes::memory() const {
  const auto sum = [](std::initializer_list<Buffer> buffers) {
    uint64_t bytes = 0;
    for (const Buffer& b : buffers) bytes += b ? b.size() : 0;
    return bytes;
  };
  std::vector<MemoryItem> items = {{"irradiance atlases", 2 * bytesOf(irradiance_[0], 16)},
                                   {"distance atlases", 2 * bytesOf(distance_[0], 8)},
                                   {"probes", sum({probes_, ages_, needed_, counters_})},
                                   {"rays of a batch", sum({rays_, hits_, radiance_})}};
  for (const auto& [name, bytes] : hitSurfaces_.memory()) items.push_back({name, bytes});
  return items;
}

std::vector<std::pair<std::string, double>> DdgiProbes::counters() const {
  std::array<uint32_t, shared::kDdgiCounters> words{};
  if (counted_) device_.download(counters_, words.data(), sizeof words);
  if (placedStale_ && counted_) {
    std::vector<vec4> places(count_);
    device_.download(probes_, places.data(), places.size() * sizeof(vec4));
    placed_ = {};
    for (uint32_t i = 0; i < count_; ++i) {
      const vec3 home = grid_.first + grid_.spacing * vec3(shared::probeAt(i, grid_.counts));
      placed_.inside += places[i].w == static_cast<float>(shared::kProbeInside);
      placed_.unneeded += places[i].w == static_cast<float>(shared::kProbeUnneeded);
      placed_.relocated += glm::length(vec3(places[i].x, places[i].y, places[i].z) - home) > 1e-3f * grid_.leastSpacing;
    }
    placedStale_ = false;
  }
  std::vector<std::pair<std::string, double>> list = {{"probes", count_},
                                                      {"inactive_probes", placed_.inside + placed_.unneeded},
                                                      {"probes_inside", placed_.inside},
                                                      {"relocated_probes", placed_.relocated},
                                                      {"probe_nan", words[shared::kCountNan]},
                                                      {"probe_inf", words[shared::kCountInf]},
                                                      {"hits_without_probe", words[shared::kCountHitsWithoutProbe]},
                                                      {"pixels_without_probe", words[shared::kCountPixelsWithoutProbe]}};
  for (const auto& [name, value] : hitSurfaces_.counters())
    if (name == "hits_back_face") list.push_back({"back_face_rays", value});
  return list;
}

PickReport DdgiProbes::pick(const PickedPoint& point, vec3 viewer) {
  struct Constants {
    vec3 position, normal, toViewer;
  } constants{point.position, point.normal, glm::normalize(viewer - point.position)};
  const Buffer weights = device_.buffer("ddgi: weights", 8 * sizeof(shared::DdgiProbeWeight));
  FrameGraph graph(device_, shaders_);
  ComputePass pass = graph.compute("ddgi: weigh", "ddgi/weigh.comp");
  bindLookup(pass);
  pass.bind("weights", weights, Access::Write).push(constants).dispatch(1);
  graph.execute();
  std::array<shared::DdgiProbeWeight, 8> probes;
  device_.download(weights, probes.data(), sizeof probes);

  std::sort(probes.begin(), probes.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  PickReport report;
  float sum = 0;
  vec3 irradiance(0.0f);
  for (const auto& p : probes) sum += p.weight, irradiance += p.weight * p.irradiance;
  const auto colour = [](vec3 c) { return fmt::format("{:.4g}, {:.4g}, {:.4g}", c.x, c.y, c.z); };
  report.facts = {{"sum of weights", fmt::format("{:.4g}", sum)}, {"irradiance", sum > 0 ? colour(irradiance / sum) : "none: no active probe near"}};
  for (const auto& p : probes) {
    const uint32_t index = shared::probeIndex(p.at, grid_.counts);
    report.facts.push_back({fmt::format("probe {} at ({}, {}, {})", index, p.at.x, p.at.y, p.at.z),
                            p.state == shared::kProbeActive
                                ? fmt::format("weight {:.4g} = trilinear {:.3g}, facing {:.3g}, visibility {:.3g}; irradiance {}", p.weight, p.trilinear,
                                              p.facing, p.visibility, colour(p.irradiance))
                                : fmt::format("weight 0: {}", stateName(p.state))});
    PickSample s;
    s.from = point.position, s.to = p.position;
    s.radiance = p.irradiance / kPi;
    s.weight = sum > 0 ? p.weight / sum : 0;
    report.samples.push_back(s);
  }
  return report;
}

}  // namespace hl
