#pragma once
// A texture as transport sees it, on the host: bilinear between texel centres, repeating, row 0 at v = 1, no mip
// levels, the sRGB curve undone before filtering. shaders/scene.glsl does the same arithmetic; a test holds the two
// together.
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/scene/scene.h"

namespace hl {

inline float srgbToLinear(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }

/// Linear value of each 8-bit sRGB code.
inline const std::array<float, 256>& srgbDecodeTable() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (size_t i = 0; i < t.size(); ++i) t[i] = srgbToLinear(static_cast<float>(i) / 255.0f);
    return t;
  }();
  return table;
}

/// The four texels round a point and how much each counts.
struct BilinearTaps {
  size_t offset[4];  ///< of the texel in Texture::rgba
  float weight[4];
};

inline BilinearTaps bilinearTaps(const Texture& t, vec2 uv) {
  const float w = static_cast<float>(t.width), h = static_cast<float>(t.height);
  const float x = (uv.x - std::floor(uv.x)) * w - 0.5f;
  const float y = (1.0f - (uv.y - std::floor(uv.y))) * h - 0.5f;
  const float fx = std::floor(x), fy = std::floor(y);
  const float ax = x - fx, ay = y - fy;
  const auto wrap = [](float i, int n) {  // i in [-1, n]
    const int k = static_cast<int>(i);
    return static_cast<size_t>(k < 0 ? k + n : k >= n ? k - n : k);
  };
  const size_t x0 = wrap(fx, t.width), x1 = wrap(fx + 1, t.width), y0 = wrap(fy, t.height), y1 = wrap(fy + 1, t.height);
  const size_t row = static_cast<size_t>(t.width);
  return {{4 * (y0 * row + x0), 4 * (y0 * row + x1), 4 * (y1 * row + x0), 4 * (y1 * row + x1)},
          {(1 - ax) * (1 - ay), ax * (1 - ay), (1 - ax) * ay, ax * ay}};
}

/// RGB linear (decoded where the texture is sRGB), alpha in [0, 1]. `uv` must be finite.
inline vec4 sampleTexture(const Texture& t, vec2 uv) {
  const BilinearTaps taps = bilinearTaps(t, uv);
  vec4 sum(0.0f);
  for (size_t i = 0; i < 4; ++i) {
    const uint8_t* p = t.rgba.data() + taps.offset[i];
    const vec3 rgb = t.srgb
                         ? vec3(srgbDecodeTable()[p[0]], srgbDecodeTable()[p[1]], srgbDecodeTable()[p[2]])
                         : vec3(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])) / 255.0f;
    sum += taps.weight[i] * vec4(rgb, static_cast<float>(p[3]) / 255.0f);
  }
  return sum;
}

inline float sampleAlpha(const Texture& t, vec2 uv) {
  const BilinearTaps taps = bilinearTaps(t, uv);
  float sum = 0;
  for (size_t i = 0; i < 4; ++i) sum += taps.weight[i] * static_cast<float>(t.rgba[taps.offset[i] + 3]) / 255.0f;
  return sum;
}

/// Texture coordinates at barycentrics (u, v) of a triangle.
inline vec2 uvAt(const Scene& scene, uint32_t triangle, float u, float v) {
  const uvec3 i = scene.indices[triangle];
  return (1 - u - v) * scene.uvs[i.x] + u * scene.uvs[i.y] + v * scene.uvs[i.z];
}

/// Albedo of a material at a place of its texture, capped at kMaxAlbedo.
inline vec3 albedoAt(const Scene& scene, const Material& m, vec2 uv) {
  if (m.albedoTexture == kNone) return glm::min(m.albedo, vec3(kMaxAlbedo));
  const vec4 texel = sampleTexture(scene.textures[m.albedoTexture], uv);
  return glm::min(m.albedo * vec3(texel.x, texel.y, texel.z), vec3(kMaxAlbedo));
}

/// Whether the material has substance at a place of its texture.
inline bool opaqueAt(const Scene& scene, const Material& m, vec2 uv) {
  if (!(m.alphaCutoff > 0) || m.albedoTexture == kNone) return true;
  return sampleAlpha(scene.textures[m.albedoTexture], uv) >= m.alphaCutoff;
}

}  // namespace hl
