#pragma once
// Receivers in clusters, and the probes that each receiver asks with their weights.
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/progress.h"
#include "engine/lightmap/atlas.h"
#include "engine/techniques/srp/params.h"
#include "engine/techniques/srp/unit.h"

namespace hl {

struct ReceiverCluster {
  uint32_t firstReceiver = 0, receivers = 0;
  uint32_t wide = 0;                       ///< the first receivers, so many, have more rows than that of irradiance
  std::vector<uint32_t> probes;            ///< that any of its receivers asks, rising
  uint32_t slots = 0;                      ///< of the receiver that asks most, at least 1
  std::vector<shared::SrpNear> near;       ///< receivers x slots; `column` counts coefficients, `coefficients` of them a probe
};

struct ReceiverClusters {
  std::vector<uint32_t> lumelOfReceiver;   ///< receivers are lumels in the order of clusters
  std::vector<ReceiverCluster> clusters;
  uint32_t receivers() const { return static_cast<uint32_t>(lumelOfReceiver.size()); }
};

/// Falloff of a probe's weight with distance over radius: 1 - 3 t^2 + 2 t^3, 0 from 1 on (equation 4.4).
float probeWeight(float t);

/// A probe that a receiver may ask.
struct AskedProbe {
  uint32_t probe;
  float weight;  ///< w of equation 4.4, above 0
};
/// Of the receiver at `at`, by number; `side` as below.
std::vector<AskedProbe> askedProbes(vec3 at, std::span<const vec3> probes, const SrpParams&, float side);

/// `side`: the longest of the scene's bounds, which params.radius is a share of [m]. `coefficients`: columns a probe. `wide`: which lumels' receivers have more rows than that of
/// irradiance; empty: none. @throws Error(Cancelled)
ReceiverClusters makeClusters(const Atlas&, std::span<const vec3> probes, const SrpParams&, float side, uint32_t coefficients, std::span<const uint8_t> wide, Progress&);

}  // namespace hl
