#ifndef HALFLIGHT_INTEROP_H
#define HALFLIGHT_INTEROP_H
// What lets one header serve C++ and GLSL. Structures use scalar layout on the GPU, which is C++'s layout for these types.
// Functions in a shared header are written in the part of GLSL that GLM also speaks; swizzles other than a single component are not.
#ifdef __cplusplus
#include <bit>
#include <cstdint>

#include "engine/core/math.h"
#define HL_INLINE inline
#define HL_OUT(type) type&
#define HL_INOUT(type) type&
#define HL_CONST inline constexpr
#define HL_BEGIN namespace hl::shared {
#define HL_END }
namespace hl::shared {
using uint = uint32_t;
using glm::abs;
using glm::acos;
using glm::asin;
using glm::atan;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::floor;
using glm::fract;
using glm::inversesqrt;
using glm::length;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::sin;
using glm::sqrt;
using glm::mat3;
using glm::mat4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
inline float uintBitsToFloat(uint u) { return std::bit_cast<float>(u); }
inline uint floatBitsToUint(float f) { return std::bit_cast<uint>(f); }
}  // namespace hl::shared
#else
#extension GL_EXT_scalar_block_layout : require
#define HL_INLINE
#define HL_OUT(type) out type
#define HL_INOUT(type) inout type
#define HL_CONST const
#define HL_BEGIN
#define HL_END
#endif
#endif
