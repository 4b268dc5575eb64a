#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of the tree's triangles that move, from the scene's vertices (engine/trace/bvh.h has the layout).
#define HL_SCENE_POSITIONS
#include "shaders/scene.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer moved_block { uint moved[]; };
layout(scalar) buffer triangles_block { vec4 triangles[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

const uint kTriangleMask = (1u << 29) - 1u;

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  const uint at = 3u * moved[i];
  const Triangle t = fetchTriangle(floatBitsToUint(triangles[at].w) & kTriangleMask);
  triangles[at].xyz = t.p0;
  triangles[at + 1u].xyz = t.p1;
  triangles[at + 2u].xyz = t.p2;
}
