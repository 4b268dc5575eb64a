#pragma once
// What a ray that met the back of a surface says: of a closed, one-sided object, that it started inside.
#include "engine/scene/scene.h"
#include "shaders/shared/ray.h"

namespace hl {

/// The geometric normal of a triangle, not normalised: twice its area long, on the side its corners run counter-clockwise on.
inline vec3 triangleNormal(const Scene& scene, uint32_t triangle) {
  const uvec3 t = scene.indices[triangle];
  return glm::cross(scene.positions[t.y] - scene.positions[t.x], scene.positions[t.z] - scene.positions[t.x]);
}

/// Whether the ray met the back of a one-sided triangle. That of a two-sided material does not count: one may stand behind a leaf.
inline bool meetsOneSidedBack(const Scene& scene, const shared::Ray& ray, const shared::Hit& hit) {
  if (hit.primitive == shared::kMiss || scene.materials[scene.materialIds[hit.primitive]].twoSided) return false;
  return glm::dot(triangleNormal(scene, hit.primitive), ray.direction) > 0;
}

}  // namespace hl
