#version 460
#extension GL_GOOGLE_include_directive : require
// One step of moving probes out of geometry and away from surfaces, by their fixed rays (after Majercik et al. 2021, section 5). A function of
// geometry alone: each run of steps starts from the lattice.
#define HL_SCENE_POSITIONS
#define HL_SCENE_MATERIALS
#include "shaders/scene.glsl"
#include "engine/techniques/ddgi/grid.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/ddgi/params.inl"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) uniform grid_block { DdgiGrid grid; };
layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) buffer probes_block { vec4 probes[]; };
layout(push_constant, scalar) uniform Constants { DdgiBatch batch; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= batch.probes) return;
  const float wanted = ddgi.relocation_distance * grid.leastSpacing;
  uint backs = 0u;
  float closestBack = 1e30, closestFront = wanted;
  vec3 wayOut = vec3(0.0), push = vec3(0.0);
  for (uint j = 0u; j < batch.rays; ++j) {
    Hit hit = hits[i * batch.rays + j];
    if (hit.primitive == kMiss) continue;
    if (batch.placing == kCastingAnew) hit.t = max(0.0, hit.t - kBacktrack * grid.leastSpacing);
    const vec3 direction = rays[i * batch.rays + j].direction;
    const vec3 normal = triangleNormal(fetchTriangle(hit.primitive));
    const float slope = dot(normal, direction);
    if (slope > 0.0 && !isTwoSided(fetchMaterial(hit.primitive))) {
      ++backs;
      if (hit.t < closestBack) closestBack = hit.t, wayOut = direction * (hit.t + 0.5 * wanted);
      continue;
    }
    // The surface goes on as a plane round the hit, which holds near it alone.
    const float height = hit.t * abs(slope);
    if (hit.t < 2.0 * wanted && height < closestFront) closestFront = height, push = (slope > 0.0 ? -normal : normal) * (wanted - height);
  }
  const uint probe = batch.firstProbe + i;
  const vec3 home = grid.first + grid.spacing * vec3(probeAt(probe, grid.counts));
  const vec3 move = float(backs) > ddgi.inside_threshold * float(batch.rays) ? wayOut : push;
  const vec3 limit = ddgi.relocation_limit * grid.spacing;
  const vec3 stood = batch.placing == kCastingAnew ? home : probes[probe].xyz;
  const vec3 offset = clamp(stood + move - home, -limit, limit);
  probes[probe].xyz = home + offset;
}
