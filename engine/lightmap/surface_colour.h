#pragma once
// Albedo and emission of a point on a triangle, textures included, for texels' means.
#include <vector>

#include <glm/vec3.hpp>

#include "engine/scene/scene.h"

namespace hl {

class SurfaceColour {
 public:
  struct Sample {
    glm::dvec3 albedo{0.0}, emission{0.0};
    bool opaque = true;
  };
  explicit SurfaceColour(const Scene& scene) : scene_(scene) {}

  /// Does it depend on where on the triangle?
  bool varies(uint32_t triangle) const { return scene_.materials[scene_.materialIds[triangle]].albedoTexture != kNone; }
  /// `weights`: of the triangle's three corners.
  Sample at(uint32_t triangle, glm::dvec3 weights) const;

 private:
  const Scene& scene_;
};

}  // namespace hl
