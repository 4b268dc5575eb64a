#pragma once
// Why a probe counts as much as it does at one receiver: the factors of the transport kernel's weight, asked again with the receiver's own rays.
#include <vector>

#include "engine/techniques/srp/params.h"
#include "engine/techniques/technique.h"

namespace hl {

struct ProbeFactors {
  uint32_t probe = 0;
  float distance = 0;    ///< w of equation 4.4
  float visibility = 0;  ///< share of the rays that hit a surface's front, of which the probe sees the place hit, from the front of it
  float blurred = 0;     ///< share of these that it sees and is not asked for, as it blurs them over more than srp.blur_limit
  float solidAngle = 1;  ///< mean of cos theta / d^2 over what it is asked for [1/m^2]; 1 where srp.probe_share is by distance
  float share = 0;       ///< of all the receiver's rays what it answers: mean of its part in the kernel's denominator
};

/// Of all probes that the lumel's receiver asks, those with the largest share first, by at most kFactorSamples of the rays that precomputation casts for it, through the same
/// passes. Blocking; some milliseconds, and what making the table of triangles takes.
std::vector<ProbeFactors> probeFactors(Gpu, const SceneView&, const SrpParams&, uint32_t lumel);

inline constexpr uint32_t kFactorSamples = 1024;

}  // namespace hl
