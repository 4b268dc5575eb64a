#ifndef HALFLIGHT_SURFEL_GUIDE_GLSL
#define HALFLIGHT_SURFEL_GUIDE_GLSL
// Guiding: a density on the unit square whose cosine-weighted directions it stands for, constant on each of 6x6 texels.
#include "engine/techniques/surfels/surfel.h"

layout(scalar) buffer guide_maps { float guideMaps[]; };

const uint kGuideTexels = kGuideSide * kGuideSide;

/// Moves uniform `u` to where the map is bright, rows first, and returns 1 / density there.
float warpByGuide(uint id, float uniformShare, inout vec2 u) {
  float rows[kGuideSide];
  float total = 0.0;
  for (uint y = 0u; y < kGuideSide; ++y) {
    rows[y] = 0.0;
    for (uint x = 0u; x < kGuideSide; ++x) rows[y] += guideMaps[id * kGuideTexels + y * kGuideSide + x];
    total += rows[y];
  }
  if (!(total > 0.0)) return 1.0;
  const float least = uniformShare / float(kGuideTexels), scale = (1.0 - uniformShare) / total;
  uint row = 0u;
  float before = 0.0, part = 0.0;
  for (; row < kGuideSide; ++row) {
    part = rows[row] * scale + least * float(kGuideSide);
    if (u.y < before + part || row == kGuideSide - 1u) break;
    before += part;
  }
  const float v = clamp((u.y - before) / part, 0.0, 0.99999994), target = u.x * part;
  uint column = 0u;
  before = 0.0;
  for (; column < kGuideSide; ++column) {
    const float probability = guideMaps[id * kGuideTexels + row * kGuideSide + column] * scale + least;
    if (target < before + probability || column == kGuideSide - 1u) {
      part = probability;
      break;
    }
    before += probability;
  }
  u = vec2((float(column) + clamp((target - before) / part, 0.0, 0.99999994)) / float(kGuideSide), (float(row) + v) / float(kGuideSide));
  u = min(u, vec2(0.99999994));
  return 1.0 / (part * float(kGuideTexels));
}
#endif
