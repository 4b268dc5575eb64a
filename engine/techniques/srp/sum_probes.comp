#version 460
#extension GL_GOOGLE_include_directive : require
// The parts of probes' samples to their coefficients, always in the same order, and the window.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/srp/params.inl"
#include "shaders/shared/spherical_harmonics.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer partSums_block { vec4 partSums[]; };
layout(scalar) writeonly buffer coefficients_block { vec4 coefficients[]; };
layout(push_constant, scalar) uniform Constants { SrpTurn turn; };

void main() {
  uint count = uint(shCount(srp.sh_order));
  uint i = gl_GlobalInvocationID.x / count;
  uint j = gl_GlobalInvocationID.x % count;
  if (i >= turn.count) return;
  vec3 sum = vec3(0.0);
  for (uint part = 0u; part < turn.parts; ++part) sum += partSums[(i * turn.parts + part) * count + j].xyz;
  int l = int(sqrt(float(j) + 0.5));
  coefficients[(turn.first + turn.stride * i) * count + j] = vec4(sum * shWindow(srp.window, l, srp.sh_order), 0.0);
}
