#version 460
#extension GL_GOOGLE_include_directive : require
// A receiver's rays: cosine distributed round its normal, so that the transport integral's cosine cancels (equation 5.6). From the centroid of the texel's
// part in the open, and not from anywhere in it as the thesis has it: none starts inside geometry.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };  // of all receivers
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= unit.receivers * unit.samples) return;
  uint receiver = unit.firstReceiver + i / unit.samples;
  SurfacePoint p = points[receiver];
  Random random = randomInit(unit.seed, p.flags, 0u);  // by lumel, whatever cluster it is in
  uint a = randomUint(random);
  uint b = randomUint(random);
  vec2 d = concentricDisc(sobolPoint(unit.firstSample + i % unit.samples, uvec2(a, b)));
  rays[i] = Ray(p.position + p.offset * p.geometricNormal, 0.0, fromLocal(vec3(d, hemisphereHeight(d)), p.geometricNormal), kRayEnd);
}
