#pragma once
// Receivers in clusters, and the probes that each receiver asks with their weights.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/core/progress.h"
#include "engine/lightmap/atlas.h"
#include "engine/techniques/srp/params.h"
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/ray.h"

namespace hl {

struct ReceiverCluster {
  uint32_t firstReceiver = 0, receivers = 0;
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

/// Of rays, whether something lies between tMin and tMax: 1 or 0 each.
using CastShadowRays = std::function<std::vector<uint32_t>(std::span<const shared::Ray>)>;
/// visible: a probe that does not see the receiver counts as so many times farther away; and so many times k probes are asked whether they do.
inline constexpr float kUnseenFarther = 3;
inline constexpr size_t kVisibleCandidates = 4;

/// `cast`: asked for support `visible` alone; rays start `offset` [m] in front of receivers. `side`: the longest of the scene's bounds, which params.radius is a share of [m]. `coefficients`: columns a probe. @throws Error(Cancelled)
ReceiverClusters makeClusters(const Atlas&, std::span<const vec3> probes, const SrpParams&, float side, uint32_t coefficients, Progress&, float offset = 0,
                              const CastShadowRays& cast = {});

}  // namespace hl
