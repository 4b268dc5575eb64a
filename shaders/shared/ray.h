#ifndef HALFLIGHT_RAY_H
#define HALFLIGHT_RAY_H
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST uint kMiss = 0xffffffffu;

/// 32 bytes. The direction need not be normalised: t is in units of its length. tMax < tMin: the ray is skipped and reads as a miss.
struct Ray {
  vec3 origin;
  float tMin;
  vec3 direction;
  float tMax;
};

/// 16 bytes. `primitive` is the scene's triangle index, or kMiss. Barycentrics: p = (1-u-v) p0 + u p1 + v p2.
struct Hit {
  float t;
  uint primitive;
  float u;
  float v;
};

HL_END
#endif
