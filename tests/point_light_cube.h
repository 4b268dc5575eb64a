#pragma once
// The point-light cube (MEASURES.md, section 1) from irradiance at lumels.
#include <array>
#include <cmath>
#include <vector>

#include "engine/lightmap/atlas.h"

namespace hl::test {

/// Indirect radiance at (0, 0), (0, .5) and (.5, .5) of a face of the scene point_light_cube, in fractions of the half side from its centre: bilinear between texels, the mean over six
/// faces and all mirrored places.
inline std::array<double, 3> cubeRadiance(const Atlas& atlas, const std::vector<vec3>& irradiance) {
  const auto at = [&](float u, float v) {
    double sum = 0, weight = 0;
    for (size_t i = 0; i < irradiance.size(); ++i) {
      const Lumel& l = atlas.lumels[i];
      const int axis = std::abs(l.normal.x) > 0.5f ? 0 : std::abs(l.normal.y) > 0.5f ? 1 : 2;
      const float a = std::abs(l.position[(axis + 1) % 3]) / 5, b = std::abs(l.position[(axis + 2) % 3]) / 5, texel = std::sqrt(l.area) / 5;
      for (const vec2 p : {vec2(u, v), vec2(v, u)}) {
        const float w = std::max(0.0f, 1 - std::abs(a - p.x) / texel) * std::max(0.0f, 1 - std::abs(b - p.y) / texel);
        sum += static_cast<double>(w * irradiance[i].y), weight += static_cast<double>(w);
      }
    }
    return 2.0 / 3 / static_cast<double>(kPi) * sum / weight;
  };
  return {at(0, 0), at(0, 0.5f), at(0.5f, 0.5f)};
}

/// What they are in truth.
inline constexpr std::array<double, 3> kCubeRadiance{468.4, 465.0, 455.7};

}  // namespace hl::test
