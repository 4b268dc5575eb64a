#version 460
#extension GL_GOOGLE_include_directive : require
// Prefix sums within chunks, and each chunk's total.
#include "engine/techniques/surfels/prefix_group.glsl"

layout(scalar) readonly buffer values_block { uint values[]; };
layout(scalar) writeonly buffer sums_block { uint sums[]; };
layout(scalar) writeonly buffer totals_block { uint totals[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

void main() {
  const uint first = (gl_WorkGroupID.x * kGroup + gl_LocalInvocationIndex) * kEach;
  uint own[kEach];
  uint sum = 0u;
  for (uint k = 0u; k < kEach; ++k) {
    own[k] = sum;
    if (first + k < count) sum += values[first + k];
  }
  uint total;
  const uint before = groupPrefix(sum, total);
  for (uint k = 0u; k < kEach; ++k)
    if (first + k < count) sums[first + k] = before + own[k];
  if (gl_LocalInvocationIndex == 0u) totals[gl_WorkGroupID.x] = total;
}
