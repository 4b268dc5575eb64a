#version 460
#extension GL_GOOGLE_include_directive : require
// Boxes of one level of nodes, from what lies under them. Writes what each node adds to the tree's cost, and of the root half its box's area.
#include "shaders/shared/interop.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer refit_nodes_block { uint refitNodes[]; };
layout(scalar) readonly buffer triangles_block { vec4 triangles[]; };
layout(scalar) buffer nodes_block { vec4 nodes[]; };
layout(scalar) writeonly buffer areas_block { float areas[]; };  // one a node to refit, then the root's
layout(push_constant, scalar) uniform Constants {
  uint first;  ///< of this level in refitNodes
  uint count;
  uint all;    ///< in refitNodes
};

const uint kLeafBit = 0x80000000u;
const uint kNodeMask = (1u << 29) - 1u;
const uint kFirstMask = (1u << 26) - 1u;
const uint kCountShift = 26u;

float halfArea(vec3 low, vec3 high) {
  const vec3 e = high - low;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  const uint node = refitNodes[first + i];
  const uint base = 7u * node;
  float area = 0.0;
  vec3 wholeLow = vec3(3.4e38), wholeHigh = vec3(-3.4e38);
  for (uint c = 0u; c < 4u; ++c) {
    if (nodes[base][c] > nodes[base + 1u][c]) continue;  // an unused slot
    const uint word = floatBitsToUint(nodes[base + 6u][c]);
    vec3 low = vec3(3.4e38), high = vec3(-3.4e38);
    float tests = 1.0;
    if ((word & kLeafBit) != 0u) {
      const uint begin = word & kFirstMask, size = ((word >> kCountShift) & 7u) + 1u;
      tests = float(size);
      for (uint t = 3u * begin; t < 3u * (begin + size); ++t) {
        low = min(low, triangles[t].xyz);
        high = max(high, triangles[t].xyz);
      }
    } else {
      const uint child = 7u * (word & kNodeMask);
      for (uint axis = 0u; axis < 3u; ++axis) {
        const vec4 lows = nodes[child + 2u * axis], highs = nodes[child + 2u * axis + 1u];
        // An unused slot's box is empty: its bounds are the wrong way round, and change neither the least nor the most.
        low[axis] = min(min(lows.x, lows.y), min(lows.z, lows.w));
        high[axis] = max(max(highs.x, highs.y), max(highs.z, highs.w));
      }
    }
    for (uint axis = 0u; axis < 3u; ++axis) {
      nodes[base + 2u * axis][c] = low[axis];
      nodes[base + 2u * axis + 1u][c] = high[axis];
    }
    area += halfArea(low, high) * tests;
    wholeLow = min(wholeLow, low);
    wholeHigh = max(wholeHigh, high);
  }
  areas[first + i] = area;
  if (node == 0u) areas[all] = halfArea(wholeLow, wholeHigh);
}
