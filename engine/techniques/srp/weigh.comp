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
  bool coarse = false;
  for (uint q = 0u; q < unit.slots; ++q) {
    uint i = r * unit.slots + q;
    float share = shares[i];
    if (share == 0.0) continue;
    bool sees = blocked[i] == 0u;
    if (sees && share > 0.0) sum += share;
    else shares[i] = 0.0;
    coarse = coarse || (sees && share < 0.0);
  }
  float scale = sum > 0.0 ? 1.0 / sum : (coarse ? kSrpCoarse : kSrpInvalid);
  Hit hit = hits[r];
  if (hit.primitive == kMiss) {
    if (unit.environment != 0u && unit.surfaceShare != 0u) scale = kSrpDark;  // what is not reflected there needs no probe to be known
  } else if (hitsBack(texelFetch(triangles, int(2u * hit.primitive + 1u)), rays[r].direction)) {
    scale = kSrpDark;
  }
  scales[r] = scale;
}
