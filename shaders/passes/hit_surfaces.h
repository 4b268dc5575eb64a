#ifndef HALFLIGHT_HIT_SURFACES_H
#define HALFLIGHT_HIT_SURFACES_H
// What C++ and shaders agree on about surfaces that rays hit.
#include "shaders/shared/interop.h"
HL_BEGIN

/// SurfacePoint::flags of a hit.
HL_CONST uint kHitNothing = 0u;   ///< the ray went into the open
HL_CONST uint kHitSurface = 1u;   ///< reflects light: a front, or the back of a two-sided material
HL_CONST uint kHitBackFace = 2u;  ///< the back of a one-sided material: reflects nothing

/// Counters, each a pair of words: low, high.
HL_CONST uint kCountHitNothing = 0u;
HL_CONST uint kCountHitBackFace = 1u;
HL_CONST uint kHitCounters = 2u;

/// Push constants. Ray and hit `first` + i become point i.
struct HitBatch {
  uint first;
  uint count;
  float offset;  ///< of the points' rays [m]
};

HL_END
#endif
