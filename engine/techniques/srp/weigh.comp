#version 460
#extension GL_GOOGLE_include_directive : require
// The denominator of the transport kernel (equation 4.10) for each of a unit's rays.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer questions_block { Ray questions[]; };
layout(scalar) readonly buffer blocked_block { uint blocked[]; };
uniform samplerBuffer triangles;
layout(scalar) writeonly buffer scales_block { float scales[]; };
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint r = gl_GlobalInvocationID.x;
  if (r >= unit.receivers * unit.samples) return;
  float sum = 0.0;
  for (uint q = 0u; q < unit.slots; ++q) {
    uint i = r * unit.slots + q;
    if (questions[i].tMax >= questions[i].tMin && blocked[i] == 0u) sum += near[(r / unit.samples) * unit.slots + q].weight;
  }
  float scale = sum > 0.0 ? 1.0 / sum : kSrpInvalid;
  Hit hit = hits[r];
  if (hit.primitive != kMiss && hitsBack(texelFetch(triangles, int(2u * hit.primitive + 1u)), rays[r].direction)) scale = kSrpDark;
  scales[r] = scale;
}
