#pragma once
// What a ray hit: position, normals and albedo, turned towards where the ray came from.
#include "engine/scene/scene.h"
#include "shaders/shared/ray.h"

namespace hl {

struct Surface {
  vec3 position{0.0f};
  vec3 geometricNormal{0.0f};  ///< of the triangle, on the ray's side, unit
  vec3 normal{0.0f};           ///< that light is weighed with: mapped, smooth or geometric; same side
  vec3 albedo{0.0f};           ///< texture included, at most kMaxAlbedo
  bool backFace = false;
  bool twoSided = false;
};

/// `mappedNormals`: the smooth vertex normal, tilted by the normal map where there is one; else the triangle's own.
Surface surfaceAt(const Scene&, const shared::Hit&, vec3 direction, bool mappedNormals);

}  // namespace hl
