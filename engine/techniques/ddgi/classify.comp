#version 460
#extension GL_GOOGLE_include_directive : require
// Which probes are asked. One that wakes starts anew.
#define HL_SCENE_POSITIONS
#define HL_SCENE_MATERIALS
#include "shaders/scene.glsl"
#include "engine/techniques/ddgi/grid.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/ddgi/params.inl"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer needed_block { uint needed[]; };
layout(scalar) buffer probes_block { vec4 probes[]; };
layout(scalar) writeonly buffer ages_block { uint ages[]; };
layout(push_constant, scalar) uniform Constants { DdgiBatch batch; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= batch.probes) return;
  const uint probe = batch.firstProbe + i;
  uint backs = 0u;
  for (uint j = 0u; j < batch.rays; ++j) {
    const Hit hit = hits[i * batch.rays + j];
    if (hit.primitive == kMiss || isTwoSided(fetchMaterial(hit.primitive))) continue;
    if (dot(triangleNormal(fetchTriangle(hit.primitive)), rays[i * batch.rays + j].direction) > 0.0) ++backs;
  }
  uint state = kProbeActive;
  if (needed[probe] == 0u) state = kProbeUnneeded;
  else if (float(backs) > ddgi.inside_threshold * float(batch.rays)) state = kProbeInside;
  if (state == kProbeActive && probes[probe].w != float(kProbeActive)) ages[probe] = 0u;
  probes[probe].w = float(state);
}
