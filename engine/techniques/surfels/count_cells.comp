#version 460
#extension GL_GOOGLE_include_directive : require
// Surfels to the world, and how many each cell will hold.
#define HL_SURFELS_STATES
#define HL_SURFELS_RECORDS
#include "engine/techniques/surfels/cache.glsl"
#define HL_SCENE_TRANSFORMS
#include "shaders/scene.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer sites_block { Surfel sites[]; };
layout(scalar) buffer cell_counts { uint cellCounts[]; };

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
  const float radius = radiusAt(position);
  records[kRecordTexels * id] = vec4(position, radius);
  records[kRecordTexels * id + 1u].xyz = normal;
  ivec3 low, high;
  cellsOf(position, normal, radius, low, high);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) atomicAdd(cellCounts[cellIndex(ivec3(x, y, z))], 1u);
}
