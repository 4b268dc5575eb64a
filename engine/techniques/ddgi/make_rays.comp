#version 460
#extension GL_GOOGLE_include_directive : require
// Rays of some probes. Those of inactive probes are not cast.
#include "engine/techniques/ddgi/directions.h"
#include "engine/techniques/ddgi/grid.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/ddgi/params.inl"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) uniform grid_block { DdgiGrid grid; };
layout(scalar) readonly buffer probes_block { vec4 probes[]; };
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { DdgiBatch batch; };

const Ray kNoRay = Ray(vec3(0.0), 1.0, vec3(0.0, 0.0, 1.0), 0.0);
const float kFar = 1e30;

void main() {
  const uint r = gl_GlobalInvocationID.x;
  if (r >= batch.probes * batch.rays) return;
  const uint probe = batch.firstProbe + r / batch.rays;
  const vec4 place = probes[probe];
  if (batch.placing == kCastingLight && place.w != float(kProbeActive)) {
    rays[r] = kNoRay;
    return;
  }
  vec3 origin = place.xyz;
  if (batch.placing == kCastingAnew) origin = grid.first + grid.spacing * vec3(probeAt(probe, grid.counts));
  vec3 direction = sphericalFibonacci(r % batch.rays, batch.rays);
  if (batch.placing == kCastingLight) {
    Random random = randomInit(batch.seed, ddgi.rotation == kRotationPerProbe ? probe + 1u : 0u, batch.frame);
    direction = rotated(direction, randomRotation(random));
  }
  if (batch.placing == kCastingAnew) origin -= direction * (kBacktrack * grid.leastSpacing);
  rays[r] = Ray(origin, 0.0, direction, kFar);
}
