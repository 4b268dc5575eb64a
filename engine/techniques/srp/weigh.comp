#version 460
#extension GL_GOOGLE_include_directive : require
// The denominator of the transport kernel (equation 4.10) for each of a unit's rays. Probes that do not see what it hit lose their share.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer blocked_block { uint blocked[]; };
uniform samplerBuffer triangles;
layout(scalar) buffer shares_block { float shares[]; };
layout(scalar) writeonly buffer scales_block { float scales[]; };
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint r = gl_GlobalInvocationID.x;
  if (r >= unit.receivers * unit.samples) return;
  float sum = 0.0;
  for (uint q = 0u; q < unit.slots; ++q) {
    uint i = r * unit.slots + q;
    float share = shares[i];
    if (share > 0.0 && blocked[i] != 0u) shares[i] = share = 0.0;
    sum += share;
  }
  float scale = sum > 0.0 ? 1.0 / sum : kSrpInvalid;
  Hit hit = hits[r];
  if (hit.primitive != kMiss && hitsBack(texelFetch(triangles, int(2u * hit.primitive + 1u)), rays[r].direction)) scale = kSrpDark;
  scales[r] = scale;
}
