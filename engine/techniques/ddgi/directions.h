#ifndef HALFLIGHT_DDGI_DIRECTIONS_H
#define HALFLIGHT_DDGI_DIRECTIONS_H
// A probe's rays: a spherical Fibonacci set, turned at random.
#include "shaders/shared/sampling.h"
HL_BEGIN

/// Point `i` of `n` on the unit sphere. Keinert et al., "Spherical Fibonacci Mapping", 2015.
HL_INLINE vec3 sphericalFibonacci(uint i, uint n) {
  float z = 1.0f - (2.0f * float(i) + 1.0f) / float(n);
  float r = sqrt(max(0.0f, 1.0f - z * z));
  float angle = 2.0f * kPi * unitFloat(i * 2654435769u);  // multiples of the golden section, as fixed-point fractions
  return vec3(r * cos(angle), r * sin(angle), z);
}

/// Uniform over all rotations, as a quaternion (x, y, z, w). Shoemake, "Uniform Random Rotations", 1992.
HL_INLINE vec4 randomRotation(HL_INOUT(Random) random) {
  float u = randomFloat(random);
  float a = 2.0f * kPi * randomFloat(random);
  float b = 2.0f * kPi * randomFloat(random);
  float p = sqrt(1.0f - u);
  float q = sqrt(u);
  return vec4(p * sin(a), p * cos(a), q * sin(b), q * cos(b));
}

HL_INLINE vec3 rotated(vec3 v, vec4 q) {
  vec3 axis = vec3(q.x, q.y, q.z);
  vec3 t = 2.0f * cross(axis, v);
  return v + q.w * t + cross(axis, t);
}

HL_END
#endif
