#version 460
#extension GL_GOOGLE_include_directive : require
// Each chunk's sums start where the chunks before it end; the sum of all behind them.
#include "engine/techniques/surfels/prefix_group.glsl"

layout(scalar) readonly buffer totals_block { uint totals[]; };
layout(scalar) buffer sums_block { uint sums[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

shared uint before;

void main() {
  const uint chunk = gl_WorkGroupID.x, i = gl_LocalInvocationIndex;
  if (i == 0u) before = 0u;
  barrier();
  uint sum = 0u;
  for (uint k = i; k < chunk; k += kGroup) sum += totals[k];
  if (sum > 0u) atomicAdd(before, sum);
  barrier();
  const uint first = chunk * kGroup * kEach;
  for (uint k = i; k < kGroup * kEach; k += kGroup)
    if (first + k < count) sums[first + k] += before;
  if (i == 0u && chunk == gl_NumWorkGroups.x - 1u) sums[count] = before + totals[chunk];
}
