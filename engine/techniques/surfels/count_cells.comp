#version 460
#extension GL_GOOGLE_include_directive : require
// Surfels to the world, and how many each cell and tile will list.
#define HL_SURFELS_STATES
#define HL_SURFELS_RECORDS
#include "engine/techniques/surfels/cache.glsl"
#define HL_SCENE_TRANSFORMS
#include "shaders/scene.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer sites_block { Surfel sites[]; };
layout(scalar) buffer cell_counts { uint cellCounts[]; };

void visit(uint list, uint) { atomicAdd(cellCounts[list], 1u); }
#include "engine/techniques/surfels/lists.glsl"

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels) return;
  if (states[id].priority == 0u) return;
  const Surfel s = sites[id];
  const ObjectTransform t = objectTransforms[s.object];
  vec3 position = s.position, normal = s.normal;
  if (t.movable != 0u) {
    position = (t.restToWorld * vec4(position, 1.0)).xyz;
    normal = normalize(transpose(mat3(t.worldToRest)) * normal);
  }
  const float radius = seenLately(states[id].lastSeen) ? radiusAt(position) : -radiusAt(position);
  records[kRecordTexels * id] = vec4(position, radius);
  records[kRecordTexels * id + 1u].xyz = normal;
  visitLists(position, normal, radius, id);
}
