#pragma once
// The emissive triangles as a light to choose from, and the densities with which they are chosen.
#include <vector>

#include "engine/scene/scene.h"

namespace hl {

struct Emitter {
  vec3 p0{0.0f}, p1{0.0f}, p2{0.0f};
  vec3 normal{0.0f};    ///< of the side that emits, unit
  vec3 emission{0.0f};  ///< radiance
  float probability = 0;  ///< of being chosen; 0 for those that only rays may find
};

class Emitters {
 public:
  explicit Emitters(const Scene&);
  bool empty() const { return emitters_.empty(); }
  bool any() const { return any_; }
  /// The emitter a uniform number chooses; kNone where none may be chosen.
  uint32_t choose(float u) const;
  const Emitter& operator[](uint32_t i) const { return emitters_[i]; }
  /// The emitter a triangle is part of, or kNone. Triangles that coincide share one, so that a doubled face is not counted twice.
  uint32_t ofTriangle(uint32_t triangle) const { return ofTriangle_.empty() ? kNone : ofTriangle_[triangle]; }

 private:
  std::vector<Emitter> emitters_;
  std::vector<float> cumulative_;  ///< up to and with emitter i
  std::vector<uint32_t> ofTriangle_;
  bool any_ = false;
};

}  // namespace hl
