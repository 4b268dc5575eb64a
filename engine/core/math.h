#pragma once
// The maths types the engine uses: GLM's, in namespace hl, with only the headers that are needed.
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace hl {
using glm::ivec2;
using glm::ivec3;
using glm::mat3;
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float kPi = 3.14159265358979323846f;

/// Luminance of linear Rec. 709 RGB.
inline float luminance(vec3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

struct Bounds {
  vec3 min{3.4e38f}, max{-3.4e38f};
  void extend(vec3 p) { min = glm::min(min, p), max = glm::max(max, p); }
  bool empty() const { return min.x > max.x; }
  float diagonal() const { return empty() ? 0.0f : glm::length(max - min); }
  vec3 centre() const { return 0.5f * (min + max); }
};
}  // namespace hl
