#ifndef HALFLIGHT_SURFACE_POINT_H
#define HALFLIGHT_SURFACE_POINT_H
#include "shaders/shared/interop.h"
HL_BEGIN

/// A point that receives light. A zero normal: no surface, receives nothing.
struct SurfacePoint {
  vec3 position;
  float offset;           ///< how far rays start in front of the surface [m]
  vec3 normal;            ///< of the receiver (mapped or geometric), unit
  uint flags;
  vec3 geometricNormal;   ///< rays start on its side
  uint triangle;
};

HL_END
#endif
