#ifndef HALFLIGHT_ROTATION_H
#define HALFLIGHT_ROTATION_H
// Rotations as unit quaternions (x, y, z, w), written once for shaders and host.
#include "shaders/shared/sampling.h"
HL_BEGIN

/// Uniform over all rotations, Shoemake, "Uniform Random Rotations", 1992.
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

/// The rotation back.
HL_INLINE vec4 inverseRotation(vec4 q) { return vec4(-q.x, -q.y, -q.z, q.w); }

HL_END
#endif
