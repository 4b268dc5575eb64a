#ifndef HALFLIGHT_OCTAHEDRAL_H
#define HALFLIGHT_OCTAHEDRAL_H
// Directions on the square [-1, 1]^2 by way of the octahedron. Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors",
// JCGT 3(2), 2014.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_INLINE float signNotZero(float x) { return x >= 0.0f ? 1.0f : -1.0f; }

/// `d` need not be unit.
HL_INLINE vec2 octahedralEncode(vec3 d) {
  float s = 1.0f / (abs(d.x) + abs(d.y) + abs(d.z));
  float x = d.x * s;
  float y = d.y * s;
  if (d.z >= 0.0f) return vec2(x, y);
  return vec2((1.0f - abs(y)) * signNotZero(x), (1.0f - abs(x)) * signNotZero(y));
}

/// Unit.
HL_INLINE vec3 octahedralDecode(vec2 p) {
  vec3 d = vec3(p.x, p.y, 1.0f - abs(p.x) - abs(p.y));
  if (d.z < 0.0f) {
    d.x = (1.0f - abs(p.y)) * signNotZero(p.x);
    d.y = (1.0f - abs(p.x)) * signNotZero(p.y);
  }
  return normalize(d);
}

HL_END
#endif
