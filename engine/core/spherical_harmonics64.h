#pragma once
// Spherical harmonics in double precision: the same definition as shaders have, for precomputation and tests.
#include "shaders/shared/spherical_harmonics.h"

namespace hl::sh64 {

using glm::cos;
using glm::sin;
using glm::sqrt;
using shared::kShMaxBandEntries;
using shared::kShMaxCoefficients;
using shared::kShMaxOrder;
using shared::kShWindowHann;
using shared::kShWindowLanczos;
using shared::kShWindowNone;
using shared::shCount;
using shared::shIndex;

#define SH_REAL double
#define SH_VEC3 glm::dvec3
#define SH_MAT3 glm::dmat3
#include "shaders/shared/spherical_harmonics_definition.h"
#undef SH_REAL
#undef SH_VEC3
#undef SH_MAT3

}  // namespace hl::sh64
