#version 460
#extension GL_GOOGLE_include_directive : require
// Probes' radiance in spherical harmonics (equation 5.1), from the lumels that their rays hit: sums over one part of a probe's samples, a workgroup each, so that a device
// is as busy with few probes as with many. Its threads fetch a chunk of radiance together; then each sums a coefficient over every so many of them.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lightmap_codes.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/srp/params.inl"
#include "shaders/shared/spherical_harmonics.h"

const uint kLanes = 64u;
layout(local_size_x = 64) in;

layout(scalar) readonly buffer codes_block { uint codes[]; };          // probes x samples
layout(scalar) readonly buffer basis_block { float basis[]; };         // samples x coefficients: Y times 4 pi / samples
uniform samplerBuffer radiance;                                        // that lumels send out
layout(scalar) writeonly buffer partSums_block { vec4 partSums[]; };   // probes that have their turn x parts x coefficients
layout(push_constant, scalar) uniform Constants { SrpTurn turn; };

shared vec3 light[kLanes];
shared vec3 sums[kLanes];

void main() {
  uint probe = turn.first + turn.stride * gl_WorkGroupID.x;
  uint part = gl_WorkGroupID.y;
  uint lane = gl_LocalInvocationIndex;
  uint count = uint(shCount(srp.sh_order));
  uint samples = uint(srp.probe_rays);
  // Order 8 has more coefficients than there are threads: the last ones are summed besides.
  uint turns = max(1u, kLanes / count), own = lane % count, which = lane / count;
  vec3 low = vec3(0.0), high = vec3(0.0);
  uint end = min(samples, (part + 1u) * kSrpPartSamples);
  for (uint chunk = part * kSrpPartSamples; chunk < end; chunk += kLanes) {
    vec3 l = vec3(0.0);
    if (chunk + lane < end) {
      uint code = codes[probe * samples + chunk + lane];
      if (code < kFirstCode) l = texelFetch(radiance, int(code)).xyz;
    }
    light[lane] = l;
    barrier();
    uint n = min(kLanes, end - chunk);
    if (which < turns)
      for (uint s = which; s < n; s += turns) low += basis[(chunk + s) * count + own] * light[s];
    if (lane + kLanes < count)
      for (uint s = 0u; s < n; ++s) high += basis[(chunk + s) * count + lane + kLanes] * light[s];
    barrier();
  }
  sums[lane] = low;
  barrier();
  uint to = (gl_WorkGroupID.x * gl_NumWorkGroups.y + part) * count;
  if (lane < count) {
    for (uint t = 1u; t < turns; ++t) low += sums[lane + t * count];
    partSums[to + lane] = vec4(low, 0.0);
  }
  if (lane + kLanes < count) partSums[to + lane + kLanes] = vec4(high, 0.0);
}
