#pragma once
// The emissive triangles as a light to choose from, and the densities with which they are chosen.
#include <algorithm>
#include <array>
#include <vector>

#include "engine/scene/scene.h"

namespace hl {

struct Emitter {
  vec3 p0{0.0f}, p1{0.0f}, p2{0.0f};
  vec3 normal{0.0f};    ///< of the side that emits, unit
  vec3 emission{0.0f};  ///< radiance
  float area = 0;
  float luminance = 0;    ///< of the emission; 0 for those that only rays may find
  float probability = 0;  ///< of being chosen by power
};

/// Up to this many emitters are chosen by about what each could send to the point, unoccluded; more by their power alone.
inline constexpr uint32_t kMaxWeighedEmitters = 32;

/// How emitters are chosen from one point. Weighed once there, for the choice and for the densities of what rays find.
struct EmitterChoice {
  std::array<float, kMaxWeighedEmitters> cumulative{};  ///< unused where chosen by power
  float total = 0;
};

class Emitters {
 public:
  explicit Emitters(const Scene&);
  bool empty() const { return emitters_.empty(); }
  /// Whether any can be chosen.
  bool any() const { return any_; }
  EmitterChoice weigh(vec3 from, vec3 normal) const;
  /// The emitter a uniform number chooses; kNone where none may be chosen.
  uint32_t choose(const EmitterChoice&, float u) const;
  float probability(const EmitterChoice&, uint32_t emitter) const;
  const Emitter& operator[](uint32_t i) const { return emitters_[i]; }
  /// The emitter a triangle is part of, or kNone. Triangles that coincide share one, so that a doubled face is not counted twice.
  uint32_t ofTriangle(uint32_t triangle) const { return ofTriangle_.empty() ? kNone : ofTriangle_[triangle]; }

 private:
  std::vector<Emitter> emitters_;
  std::vector<float> cumulative_;  ///< up to and with emitter i
  std::vector<uint32_t> ofTriangle_;
  bool any_ = false, weighed_ = false;
};

}  // namespace hl
