#include "engine/trace/alpha_test.h"

#include <algorithm>
#include <cmath>

namespace hl {
namespace {

size_t wrapped(float x, int size) {
  const float f = x - std::floor(x / static_cast<float>(size)) * static_cast<float>(size);
  return std::min(static_cast<size_t>(f), static_cast<size_t>(size) - 1);
}

/// Bilinear alpha in [0, 1]; v points up, rows run from the top, the texture repeats.
float alphaAt(const Texture& texture, vec2 uv) {
  const float x = (uv.x - std::floor(uv.x)) * static_cast<float>(texture.width) - 0.5f;
  const float y = (1.0f - (uv.y - std::floor(uv.y))) * static_cast<float>(texture.height) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y);
  const auto texel = [&](float column, float row) {
    const size_t i = wrapped(row, texture.height) * static_cast<size_t>(texture.width) + wrapped(column, texture.width);
    return static_cast<float>(texture.rgba[4 * i + 3]) / 255.0f;
  };
  const float top = glm::mix(texel(x0, y0), texel(x0 + 1, y0), x - x0);
  const float bottom = glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), x - x0);
  return glm::mix(top, bottom, y - y0);
}

}  // namespace

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
  const Material& m = scene.materials[scene.materialIds[triangle]];
  if (!(m.alphaCutoff > 0) || m.albedoTexture == kNone) return true;
  const uvec3 i = scene.indices[triangle];
  const vec2 uv = (1.0f - u - v) * scene.uvs[i.x] + u * scene.uvs[i.y] + v * scene.uvs[i.z];
  return alphaAt(scene.textures[m.albedoTexture], uv) >= m.alphaCutoff;
}

}  // namespace hl
