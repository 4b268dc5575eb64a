#ifndef HALFLIGHT_DDGI_DIRECTIONS_H
#define HALFLIGHT_DDGI_DIRECTIONS_H
// A probe's rays: a spherical Fibonacci set, turned at random.
#include "shaders/shared/rotation.h"
#include "shaders/shared/sampling.h"
HL_BEGIN

/// Point `i` of `n` on the unit sphere. Keinert et al., "Spherical Fibonacci Mapping", 2015.
HL_INLINE vec3 sphericalFibonacci(uint i, uint n) {
  float z = 1.0f - (2.0f * float(i) + 1.0f) / float(n);
  float r = sqrt(max(0.0f, 1.0f - z * z));
  float angle = 2.0f * kPi * unitFloat(i * 2654435769u);  // multiples of the golden section, as fixed-point fractions
  return vec3(r * cos(angle), r * sin(angle), z);
}

HL_END
#endif
