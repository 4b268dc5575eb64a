#include "engine/lightmap/surface_colour.h"

#include "engine/scene/texture_sampling.h"

namespace hl {

SurfaceColour::Sample SurfaceColour::at(uint32_t triangle, glm::dvec3 weights) const {
  const Material& m = scene_.materials[scene_.materialIds[triangle]];
  Sample s;
  s.emission = m.emission;
  if (m.albedoTexture == kNone) {
    s.albedo = glm::min(m.albedo, vec3(kMaxAlbedo));
    return s;
  }
  const vec2 uv = uvAt(scene_, triangle, static_cast<float>(weights.y), static_cast<float>(weights.z));
  s.albedo = albedoAt(scene_, m, uv);
  s.opaque = opaqueAt(scene_, m, uv);
  return s;
}

}  // namespace hl
