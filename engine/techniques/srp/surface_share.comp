#version 460
#extension GL_GOOGLE_include_directive : require
// Which of a probe's directions end on a surface that has lumels, in spherical harmonics: a thread a probe and coefficient, of probes [first, first + probes).
#include "shaders/shared/lightmap_codes.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer codes_block { uint codes[]; };    // probes x samples
layout(scalar) readonly buffer basis_block { float basis[]; };   // samples x coefficients: Y times 4 pi / samples
layout(scalar) writeonly buffer surfaces_block { float surfaces[]; };
layout(push_constant, scalar) uniform Constants { uint first, probes, samples, coefficients; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= probes * coefficients) return;
  uint probe = first + i / coefficients, j = i % coefficients;
  float sum = 0.0;
  for (uint s = 0u; s < samples; ++s)
    if (codes[probe * samples + s] < kFirstCode) sum += basis[s * coefficients + j];
  surfaces[first * coefficients + i] = sum;
}
