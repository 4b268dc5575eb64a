#include "engine/techniques/srp/pick.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/techniques/srp/probe_factors.h"
#include "shaders/shared/spherical_harmonics.h"

namespace hl {
namespace {

constexpr size_t kMostFacts = 8;

/// "weight of probe 12": "0.24 of the rays = distance 0.62 x sees 71 % x 0.13 /m^2, over the sum".
std::vector<std::pair<std::string, std::string>> factorFacts(const std::vector<ProbeFactors>& factors, const SceneView& scene, const SrpParams& params) {
  std::vector<std::pair<std::string, std::string>> facts;
  for (size_t i = 0; i < std::min(factors.size(), kMostFacts); ++i) {
    const ProbeFactors& f = factors[i];
    std::string text = fmt::format("{:.1f} % of the rays = distance {:.3g}, sees {:.1f} % of what is hit", 100 * f.share, f.distance, 100 * f.visibility);
    if (f.blurred > 0) text += fmt::format(" ({:.1f} % blurs too much)", 100 * f.blurred);
    if (params.probe_share == kShareSolidAngle) text += fmt::format(", solid angle {:.3g} /m^2", f.solidAngle);
    const vec3 at = scene.probes->positions[f.probe];
    facts.push_back({fmt::format("weight of the probe at {:.2f}, {:.2f}, {:.2f}", at.x, at.y, at.z), text});
  }
  return facts;
}

}  // namespace

PickReport pickReceiver(const SceneView& scene, Gpu gpu, const ReceiverClusters& clusters, std::span<const ClusterTransport> transport, const SrpRuntime& runtime,
                        const SrpParams& params, const PickedPoint& point) {
  Device& device = gpu.device;
  const Atlas& atlas = *scene.atlas;
  const int side = atlas.resolution;
  const ivec2 at = glm::clamp(ivec2(point.lightmapUv * static_cast<float>(side)), ivec2(0), ivec2(side - 1));
  const uint32_t lumel = atlas.lumelOfTexel[static_cast<size_t>(at.y) * static_cast<size_t>(side) + static_cast<size_t>(at.x)];
  PickReport report;
  report.facts = {{"texel", fmt::format("({}, {})", at.x, at.y)}};
  if (lumel == kNone) {
    report.facts.push_back({"state", "no valid texel"});
    return report;
  }
  const auto receiver = static_cast<uint32_t>(std::find(clusters.lumelOfReceiver.begin(), clusters.lumelOfReceiver.end(), lumel) - clusters.lumelOfReceiver.begin());
  size_t which = 0;
  while (which + 1 < clusters.clusters.size() && clusters.clusters[which + 1].firstReceiver <= receiver) ++which;
  const ReceiverCluster& c = clusters.clusters[which];
  const ClusterTransport& t = transport[which];
  const uint32_t row = receiver - c.firstReceiver;

  // Its transport vector, as it is after compression.
  std::vector<double> alpha(t.columns);
  for (uint32_t k = 0; k < t.rank; ++k) {
    const auto w = static_cast<double>(t.weights[size_t{row} * t.rank + k]);
    if (t.basis.empty()) alpha[k] = w;
    for (uint32_t i = 0; i < t.columns && !t.basis.empty(); ++i) alpha[i] += w * static_cast<double>(t.basis[size_t{k} * t.columns + i]);
  }
  const auto coefficients = static_cast<uint32_t>(shared::shCount(params.sh_order));
  std::vector<vec4> light(runtime.coefficients().size() / sizeof(vec4));
  device.download(runtime.coefficients(), light.data(), light.size() * sizeof(vec4));
  const vec3 position = atlas.lumels[lumel].position;
  vec3 sum(0.0f);
  double norm = 0;
  for (double a : alpha) norm += a * a;
  for (size_t p = 0; p < c.probes.size(); ++p) {
    vec3 brings(0.0f);
    double own = 0;
    for (uint32_t j = 0; j < coefficients; ++j) {
      const double a = alpha[p * coefficients + j];
      const vec4 l = light[size_t{c.probes[p]} * coefficients + j];
      brings += static_cast<float>(a) * vec3(l.x, l.y, l.z);
      own += a * a;
    }
    sum += brings;
    PickSample s;
    s.from = position, s.to = scene.probes->positions[c.probes[p]];
    s.radiance = brings;
    s.weight = norm > 0 ? static_cast<float>(own / norm) : 0.0f;
    if (s.weight > 0) report.samples.push_back(s);
  }
  if (!t.reads.empty()) {
    size_t first = 0;
    for (uint32_t r = 0; r < row; ++r) first += t.readsOf[r];
    std::vector<vec4> radiance(runtime.radiance().size() / sizeof(vec4));
    device.download(runtime.radiance(), radiance.data(), radiance.size() * sizeof(vec4));
    vec3 brings(0.0f);
    for (size_t i = first; i < first + t.readsOf[row]; ++i) {
      const vec4 l = radiance[t.reads[i].lumel];
      brings += t.reads[i].weight * vec3(l.x, l.y, l.z);
    }
    sum += brings;
    report.facts.push_back({"read off surfaces", fmt::format("{} lumels: {:.4g} of the irradiance", t.readsOf[row], luminance(brings))});
  }
  report.facts.push_back({"receiver", fmt::format("{} of {}, in cluster {} with {} others", receiver, clusters.receivers(), which, c.receivers - 1)});
  report.facts.push_back({"probes of the cluster", fmt::format("{}", c.probes.size())});
  report.facts.push_back({"light vectors", fmt::format("{} for {} coefficients", t.rank, t.columns)});
  report.facts.push_back({"valid samples", fmt::format("{:.1f} %", 100 * t.valid[row])});
  report.facts.push_back({"indirect irradiance", fmt::format("{:.4g}, {:.4g}, {:.4g}", sum.x, sum.y, sum.z)});
  for (const auto& [name, text] : factorFacts(probeFactors(gpu, scene, params, lumel), scene, params)) report.facts.push_back({name, text});
  std::vector<size_t> order(report.samples.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return luminance(report.samples[a].radiance) > luminance(report.samples[b].radiance); });
  for (size_t i = 0; i < std::min<size_t>(order.size(), 8); ++i) {
    const PickSample& s = report.samples[order[i]];
    report.facts.push_back({fmt::format("probe at {:.2f}, {:.2f}, {:.2f}", s.to.x, s.to.y, s.to.z),
                            fmt::format("{:.4g} of the irradiance, {:.1f} % of the transport", luminance(s.radiance), 100 * s.weight)});
  }
  return report;
}

}  // namespace hl
