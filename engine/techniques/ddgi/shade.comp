#version 460
#extension GL_GOOGLE_include_directive : require
// What comes back along each ray: L = albedo / pi (E direct + E of the probes), and how far it went. Emission and sky are direct light at the probe.
#include "engine/techniques/ddgi/lookup.glsl"
#include "shaders/passes/hit_surfaces.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
layout(scalar) readonly buffer albedo_block { vec4 albedo[]; };
layout(scalar) readonly buffer direct_block { vec4 direct[]; };
layout(scalar) writeonly buffer radiance_block { vec4 radiance[]; };  // w: proximity
layout(scalar) buffer counters_block { uint counters[]; };
layout(push_constant, scalar) uniform Constants { DdgiBatch batch; };

shared uint withoutProbe;

vec4 returned(uint i) {
  const SurfacePoint p = points[i];
  if (p.flags == kHitNothing) return vec4(vec3(0.0), proximity(kNothing));
  const float near = proximity(hits[i].t);
  if (p.flags == kHitBackFace) return vec4(vec3(0.0), near);
  const vec4 d = direct[i];
  vec3 e = d.w > 0.0 ? d.xyz / d.w : vec3(0.0);
  if (ddgi.multi_bounce != 0) {
    const vec4 cached = cachedIrradiance(p.position, p.normal, p.geometricNormal, -rays[i].direction);
    e += cached.xyz;
    if (cached.w == 0.0) atomicAdd(withoutProbe, 1u);
  }
  return vec4(albedo[i].xyz * e / kPi, near);
}

void main() {
  if (gl_LocalInvocationIndex == 0u) withoutProbe = 0u;
  barrier();
  const uint i = gl_GlobalInvocationID.x;
  if (i < batch.probes * batch.rays) radiance[i] = returned(i);
  barrier();
  if (gl_LocalInvocationIndex == 0u && withoutProbe > 0u) atomicAdd(counters[kCountHitsWithoutProbe], withoutProbe);
}
