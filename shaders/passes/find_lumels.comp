#version 460
#extension GL_GOOGLE_include_directive : require
// From hits to the lumels that were hit. A pass of its own, so that a cached ray goes the very same way as a new one.
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

uniform samplerBuffer rays;  // of which only directions are read: a quarter of what a storage buffer's scattered loads cost on a CPU
layout(scalar) readonly buffer hits_block { Hit hits[]; };
uniform samplerBuffer triangles;
layout(scalar) readonly buffer lumelOfTexel_block { uint lumelOfTexel[]; };
layout(scalar) writeonly buffer codes_block { uint codes[]; };
layout(push_constant, scalar) uniform Constants { LumelSearch search; };

void main() {
  uint r = gl_GlobalInvocationID.x;
  if (r >= search.rays) return;
  Hit hit = hits[r];
  uint code = kCodeMiss;
  if (hit.primitive != kMiss) {
    vec4 first = texelFetch(triangles, int(2u * hit.primitive));
    vec4 second = texelFetch(triangles, int(2u * hit.primitive + 1u));
    vec3 direction = texelFetch(rays, int(2u * r + 1u)).xyz;
    code = hitsBack(second, direction) ? kCodeBackFace : codeOfLumel(lumelOfTexel[texelHit(first, second, hit.u, hit.v, search.resolution)]);
  }
  codes[search.codeBase + r] = code;
}
