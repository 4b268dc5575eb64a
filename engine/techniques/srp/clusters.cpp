#include "engine/techniques/srp/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace hl {
namespace {

using Range = std::span<uint32_t>;

/// Tight boxes halved along their longest side, until they hold few enough (section 5.6.6).
void splitBoxes(const Atlas& atlas, Range lumels, size_t most, std::vector<Range>& out) {
  if (lumels.size() <= most) {
    if (!lumels.empty()) out.push_back(lumels);
    return;
  }
  vec3 low(INFINITY), high(-INFINITY);
  for (uint32_t l : lumels) low = glm::min(low, atlas.lumels[l].position), high = glm::max(high, atlas.lumels[l].position);
  const vec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
  const float middle = 0.5f * (low[axis] + high[axis]);
  // Of one place alone there is no half: then half their number.
  auto split = std::stable_partition(lumels.begin(), lumels.end(), [&](uint32_t l) { return atlas.lumels[l].position[axis] < middle; });
  if (split == lumels.begin() || split == lumels.end()) split = lumels.begin() + static_cast<std::ptrdiff_t>(lumels.size() / 2);
  const auto left = static_cast<size_t>(split - lumels.begin());
  splitBoxes(atlas, lumels.first(left), most, out);
  splitBoxes(atlas, lumels.subspan(left), most, out);
}

/// Position over `length`, and normal: two receivers a `length` apart differ as much as two whose normals stand at 60 degrees.
using Feature = std::array<float, 6>;
Feature feature(const Lumel& l, float length) {
  const vec3 p = l.position / length;
  return {p.x, p.y, p.z, l.normal.x, l.normal.y, l.normal.z};
}
float distance2(const Feature& a, const Feature& b) {
  float sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Two means, each receiver to the nearer one, a fixed number of times; and again in each half that is too large.
void splitMeans(const Atlas& atlas, Range lumels, size_t most, std::vector<Range>& out) {
  constexpr int kIterations = 8;
  if (lumels.size() <= most) {
    if (!lumels.empty()) out.push_back(lumels);
    return;
  }
  vec3 low(INFINITY), high(-INFINITY);
  for (uint32_t l : lumels) low = glm::min(low, atlas.lumels[l].position), high = glm::max(high, atlas.lumels[l].position);
  const float length = std::max(glm::length(high - low), 1e-20f);
  std::array<Feature, 2> means{feature(atlas.lumels[lumels.front()], length), {}};
  // The second starts at what is farthest from the first.
  uint32_t farthest = lumels.front();
  for (uint32_t l : lumels)
    if (distance2(feature(atlas.lumels[l], length), means[0]) > distance2(feature(atlas.lumels[farthest], length), means[0])) farthest = l;
  means[1] = feature(atlas.lumels[farthest], length);
  const auto nearer = [&](uint32_t l) {
    const Feature f = feature(atlas.lumels[l], length);
    return distance2(f, means[0]) <= distance2(f, means[1]);
  };
  for (int i = 0; i < kIterations; ++i) {
    std::array<std::array<double, 6>, 2> sums{};
    std::array<double, 2> counts{};
    for (uint32_t l : lumels) {
      const size_t which = nearer(l) ? 0 : 1;
      const Feature f = feature(atlas.lumels[l], length);
      for (size_t d = 0; d < f.size(); ++d) sums[which][d] += static_cast<double>(f[d]);
      ++counts[which];
    }
    for (size_t w = 0; w < 2; ++w)
      for (size_t d = 0; d < means[w].size(); ++d)
        if (counts[w] > 0) means[w][d] = static_cast<float>(sums[w][d] / counts[w]);
  }
  auto split = std::stable_partition(lumels.begin(), lumels.end(), nearer);
  if (split == lumels.begin() || split == lumels.end()) split = lumels.begin() + static_cast<std::ptrdiff_t>(lumels.size() / 2);
  const auto left = static_cast<size_t>(split - lumels.begin());
  splitMeans(atlas, lumels.first(left), most, out);
  splitMeans(atlas, lumels.subspan(left), most, out);
}

/// `least_clusters` makes no smaller ones: their bases would be larger than what they save.
constexpr size_t kSmallestPart = 64;

}  // namespace

std::vector<AskedProbe> askedProbes(vec3 at, std::span<const vec3> probes, const SrpParams& params, float side) {
  std::vector<std::pair<float, uint32_t>> byDistance(probes.size());
  for (uint32_t i = 0; i < probes.size(); ++i) byDistance[i] = {glm::distance(at, probes[i]), i};
  float radius = params.radius * side;
  size_t count = byDistance.size();
  if (params.support == kSupportReceiverRadius) {
    const auto k = static_cast<size_t>(params.k);
    const size_t sorted = std::min(k + 1, byDistance.size());
    std::partial_sort(byDistance.begin(), byDistance.begin() + static_cast<std::ptrdiff_t>(sorted), byDistance.end());
    // To the first that is left out, so that weights end at 0; where all are asked, to twice the farthest. Probes that are all equally far keep a little of it.
    count = std::min(k, byDistance.size());
    constexpr float kLeastReach = 1.01f;
    if (count > 0) radius = byDistance.size() > k ? std::max(byDistance[k].first, kLeastReach * byDistance[count - 1].first) : 2 * byDistance[count - 1].first;
  }
  std::vector<AskedProbe> asked;
  for (size_t i = 0; i < count; ++i) {
    // At a radius of 0 the probe is where the receiver is.
    const float w = radius > 0 ? probeWeight(byDistance[i].first / radius) : 1.0f;
    if (w > 0) asked.push_back({byDistance[i].second, w});
  }
  std::sort(asked.begin(), asked.end(), [](const AskedProbe& a, const AskedProbe& b) { return a.probe < b.probe; });
  return asked;
}

float probeWeight(float t) { return t < 1 ? 1 + t * t * (2 * t - 3) : 0.0f; }

ReceiverClusters makeClusters(const Atlas& atlas, std::span<const vec3> probes, const SrpParams& params, float side, uint32_t coefficients, std::span<const uint8_t> wide,
                              Progress& progress) {
  ReceiverClusters result;
  result.lumelOfReceiver.resize(atlas.lumels.size());
  std::iota(result.lumelOfReceiver.begin(), result.lumelOfReceiver.end(), 0u);
  std::vector<Range> ranges;
  const size_t part = std::max<size_t>(kSmallestPart, atlas.lumels.size() / static_cast<size_t>(params.least_clusters));
  const size_t most = std::min<size_t>(static_cast<size_t>(params.cluster_size), part);
  if (params.clustering == kClusteringLbg) splitMeans(atlas, result.lumelOfReceiver, most, ranges);
  else splitBoxes(atlas, result.lumelOfReceiver, most, ranges);

  for (const Range& range : ranges) {
    progress.check();
    ReceiverCluster c;
    c.firstReceiver = static_cast<uint32_t>(range.data() - result.lumelOfReceiver.data());
    c.receivers = static_cast<uint32_t>(range.size());
    if (!wide.empty()) c.wide = static_cast<uint32_t>(std::stable_partition(range.begin(), range.end(), [&](uint32_t l) { return wide[l] != 0; }) - range.begin());
    std::vector<std::vector<AskedProbe>> asked;
    asked.reserve(range.size());
    for (uint32_t l : range) {
      asked.push_back(askedProbes(atlas.lumels[l].position, probes, params, side));
      c.slots = std::max(c.slots, static_cast<uint32_t>(asked.back().size()));
      for (const AskedProbe& a : asked.back()) c.probes.push_back(a.probe);
    }
    std::sort(c.probes.begin(), c.probes.end());
    c.probes.erase(std::unique(c.probes.begin(), c.probes.end()), c.probes.end());
    c.slots = std::max(c.slots, 1u);
    c.near.assign(static_cast<size_t>(c.receivers) * c.slots, {0, 0, 0.0f});
    for (size_t r = 0; r < asked.size(); ++r) {
      for (size_t q = 0; q < asked[r].size(); ++q) {
        const auto local = static_cast<uint32_t>(std::lower_bound(c.probes.begin(), c.probes.end(), asked[r][q].probe) - c.probes.begin());
        c.near[r * c.slots + q] = {asked[r][q].probe, local * coefficients, asked[r][q].weight};
      }
    }
    result.clusters.push_back(std::move(c));
  }
  return result;
}

}  // namespace hl
