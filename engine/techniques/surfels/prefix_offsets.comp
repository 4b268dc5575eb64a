#version 460
#extension GL_GOOGLE_include_directive : require
// Each chunk's sums start where the chunks before it end.
#include "engine/techniques/surfels/prefix_group.glsl"

layout(scalar) readonly buffer totals_block { uint totals[]; };
layout(scalar) buffer sums_block { uint sums[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i > count) return;
  const uint chunk = i / (kGroup * kEach);
  if (i == count) sums[i] = totals[(count + kGroup * kEach - 1u) / (kGroup * kEach)];
  else sums[i] += totals[chunk];
}
