#include "engine/trace/alpha_test.h"

#include "engine/scene/texture_sampling.h"

namespace hl {
bool alphaTested(const Scene& scene, const Material& m) {
  if (!(m.alphaCutoff > 0) || m.albedoTexture == kNone) return false;
  const Texture& t = scene.textures[m.albedoTexture];
  for (size_t i = 3; i < t.rgba.size(); i += 4)
    if (static_cast<float>(t.rgba[i]) < m.alphaCutoff * 255.0f) return true;
  return false;
}

std::vector<bool> alphaTestedTriangles(const Scene& scene) {
  std::vector<bool> materials(scene.materials.size());
  bool any = false;
  for (size_t i = 0; i < materials.size(); ++i) {
    materials[i] = alphaTested(scene, scene.materials[i]);
    any = any || materials[i];
  }
  if (!any) return {};
  std::vector<bool> tested(scene.indices.size());
  bool used = false;
  for (size_t t = 0; t < tested.size(); ++t) {
    tested[t] = materials[scene.materialIds[t]];
    used = used || tested[t];
  }
  return used ? tested : std::vector<bool>{};
}

bool opaqueAt(const Scene& scene, uint32_t triangle, float u, float v) {
  return opaqueAt(scene, scene.materials[scene.materialIds[triangle]], uvAt(scene, triangle, u, v));
}

}  // namespace hl
