#version 460
#extension GL_GOOGLE_include_directive : require
// Marks the probes round every cell that a triangle reaches into, to which points on it (moved by the biases) belong. No surface is too small.
#define HL_SCENE_POSITIONS
#include "shaders/scene.glsl"
#include "engine/techniques/ddgi/grid.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/ddgi/params.inl"

layout(local_size_x = 64) in;

layout(scalar) uniform grid_block { DdgiGrid grid; };
layout(scalar) buffer needed_block { uint needed[]; };
layout(push_constant, scalar) uniform Constants { uint triangles; };

void main() {
  const uint triangle = gl_GlobalInvocationID.x;
  if (triangle >= triangles) return;
  const Triangle t = fetchTriangle(triangle);
  const float reach = (ddgi.normal_bias + ddgi.view_bias + 0.01) * grid.leastSpacing;
  const vec3 low = (min(t.p0, min(t.p1, t.p2)) - reach - grid.first) / grid.spacing;
  const vec3 high = (max(t.p0, max(t.p1, t.p2)) + reach - grid.first) / grid.spacing;
  // Points beyond the outermost probes belong to the cells there.
  const ivec3 most = max(ivec3(grid.counts) - 2, ivec3(0));
  const ivec3 from = clamp(ivec3(floor(low)), ivec3(0), most), to = clamp(ivec3(floor(high)), ivec3(0), most);
  const vec3 normal = cross(t.p1 - t.p0, t.p2 - t.p0);
  const vec3 halfSize = 0.5 * grid.spacing + reach;
  for (int z = from.z; z <= to.z; ++z) {
    for (int y = from.y; y <= to.y; ++y) {
      for (int x = from.x; x <= to.x; ++x) {
        const ivec3 cell = ivec3(x, y, z);
        // A cell at the rim reaches on for ever: its box says nothing.
        const bool rim = any(equal(cell, ivec3(0))) || any(equal(cell, most));
        const vec3 centre = grid.first + (vec3(cell) + 0.5) * grid.spacing;
        if (!rim && abs(dot(normal, t.p0 - centre)) > dot(abs(normal), halfSize)) continue;
        for (uint corner = 0u; corner < 8u; ++corner) {
          const uvec3 at = min(uvec3(cell) + (uvec3(corner, corner >> 1, corner >> 2) & 1u), grid.counts - 1u);
          atomicOr(needed[probeIndex(at, grid.counts)], 1u);
        }
      }
    }
  }
}
