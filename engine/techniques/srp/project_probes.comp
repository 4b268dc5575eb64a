#version 460
#extension GL_GOOGLE_include_directive : require
// Probes' radiance in spherical harmonics (equation 5.1), from the lumels that their rays hit. One workgroup a probe: its threads fetch a chunk of radiance
// together, then each sums one or two coefficients over it.
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
layout(scalar) writeonly buffer coefficients_block { vec4 coefficients[]; };
layout(push_constant, scalar) uniform Constants { uint probes, first, stride; };  // of all: first, first + stride, ...

shared vec3 light[kLanes];

float window(uint j) {
  int l = int(sqrt(float(j) + 0.5));
  return shWindow(srp.window, l, srp.sh_order);
}

void main() {
  uint probe = first + stride * gl_WorkGroupID.x;
  uint lane = gl_LocalInvocationIndex;
  uint count = uint(shCount(srp.sh_order));
  uint samples = uint(srp.probe_rays);
  vec3 low = vec3(0.0), high = vec3(0.0);
  for (uint chunk = 0u; chunk < samples; chunk += kLanes) {
    vec3 l = vec3(0.0);
    if (probe < probes && chunk + lane < samples) {
      uint code = codes[probe * samples + chunk + lane];
      if (code < kFirstCode) l = texelFetch(radiance, int(code)).xyz;
    }
    light[lane] = l;
    barrier();
    uint n = min(kLanes, samples - chunk);
    if (lane < count)
      for (uint s = 0u; s < n; ++s) low += basis[(chunk + s) * count + lane] * light[s];
    if (lane + kLanes < count)
      for (uint s = 0u; s < n; ++s) high += basis[(chunk + s) * count + lane + kLanes] * light[s];
    barrier();
  }
  if (probe >= probes) return;
  if (lane < count) coefficients[probe * count + lane] = vec4(low * window(lane), 0.0);
  if (lane + kLanes < count) coefficients[probe * count + lane + kLanes] = vec4(high * window(lane + kLanes), 0.0);
}
