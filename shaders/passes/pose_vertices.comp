#version 460
#extension GL_GOOGLE_include_directive : require
// Vertices of moving objects in world space.
#include "shaders/shared/scene_types.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer moving_vertices_block { MovingVertex movingVertices[]; };
layout(scalar) readonly buffer object_transforms { ObjectTransform objectTransforms[]; };
layout(scalar) writeonly buffer positions_block { vec3 positions[]; };
layout(scalar) writeonly buffer normals_block { vec3 normals[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  const MovingVertex v = movingVertices[i];
  positions[v.vertex] = (objectTransforms[v.object].restToWorld * vec4(v.position, 1.0)).xyz;
  const vec3 n = transpose(mat3(objectTransforms[v.object].worldToRest)) * v.normal;
  const float squared = dot(n, n);
  normals[v.vertex] = squared > 0.0 ? n * inversesqrt(squared) : v.normal;
}
