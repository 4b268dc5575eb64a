#include "engine/techniques/srp/directional.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hl {

std::vector<vec2> directionalTable() {
  constexpr int kRings = 128, kSteps = 256;  // midpoints, of a function with a kink: good to 1e-4
  constexpr double kLeastCosine = 0.5;
  std::vector<vec2> table;
  for (int i = 0; i < kDirectionalEntries; ++i) {
    const double c = static_cast<double>(i) / (kDirectionalEntries - 1), s = std::sqrt(1 - c * c);
    // Tangential and normal part are apart: over the cone the mean of n_x (n_z - 1) is 0.
    double along = 0, alongAll = 0, up = 0, upAll = 0;
    for (int ring = 0; ring < kRings; ++ring) {
      const double z = 1 - (1 - kLeastCosine) * (ring + 0.5) / kRings, r = std::sqrt(1 - z * z);
      for (int step = 0; step < kSteps; ++step) {
        const double x = r * std::cos(2 * std::numbers::pi * (step + 0.5) / kSteps);
        const double more = std::max(0.0, s * x + c * z) - c;
        along += more * x, alongAll += x * x;
        up += more * (z - 1), upAll += (z - 1) * (z - 1);
      }
    }
    table.push_back(vec2(static_cast<float>(along / alongAll), static_cast<float>(up / upAll)));
  }
  return table;
}

Buffer directionalBuffer(Device& device, const SrpParams& params) {
  const std::vector<vec2> table = params.receivers == kReceiversDirectional ? directionalTable() : std::vector<vec2>(1, vec2(0.0f));
  return device.buffer("srp: slopes of irradiance by height", std::span<const vec2>(table));
}

}  // namespace hl
