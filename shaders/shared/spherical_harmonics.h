#ifndef HALFLIGHT_SPHERICAL_HARMONICS_H
#define HALFLIGHT_SPHERICAL_HARMONICS_H
// Spherical harmonics of any order to 8 in single precision, for shaders and host.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST int kShMaxOrder = 8;
HL_CONST int kShMaxCoefficients = 81;
HL_CONST int kShMaxBandEntries = 289;

/// Windows against ringing: how bands fade out towards order + 1. Band 0 stays.
HL_CONST int kShWindowNone = 0;
HL_CONST int kShWindowHann = 1;
HL_CONST int kShWindowLanczos = 2;

HL_INLINE int shIndex(int l, int m) { return l * l + l + m; }
HL_INLINE int shCount(int order) { return (order + 1) * (order + 1); }

#define SH_REAL float
#define SH_VEC3 vec3
#define SH_MAT3 mat3
#include "shaders/shared/spherical_harmonics_definition.h"
#undef SH_REAL
#undef SH_VEC3
#undef SH_MAT3
HL_END
#endif
