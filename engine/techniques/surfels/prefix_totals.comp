#version 460
#extension GL_GOOGLE_include_directive : require
// Prefix sums of the chunks' totals, in place; the sum of all behind them.
#include "engine/techniques/surfels/prefix_group.glsl"

layout(scalar) buffer totals_block { uint totals[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

void main() {
  uint carried = 0u;
  for (uint first = 0u; first < count; first += kGroup) {
    const uint i = first + gl_LocalInvocationIndex;
    uint total;
    const uint before = groupPrefix(i < count ? totals[i] : 0u, total);
    if (i < count) totals[i] = carried + before;
    carried += total;
  }
  if (gl_LocalInvocationIndex == 0u) totals[count] = carried;
}
