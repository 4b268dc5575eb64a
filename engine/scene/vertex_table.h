#pragma once
// Joins equal vertices while a mesh is converted: importers hand out one a triangle corner.
#include <cstring>
#include <vector>

#include "engine/scene/scene.h"

namespace hl {

struct MeshVertex {
  vec3 position{0.0f}, normal{0.0f};
  vec2 uv{0.0f}, lightmapUv{0.0f};
};

/// Open addressing over the vertices' bits; adds new ones to the scene.
class VertexTable {
 public:
  VertexTable(Scene& scene, bool lightmapUvs) : scene_(scene), lightmapUvs_(lightmapUvs), slots_(1 << 16, kNone) {}

  uint32_t add(const MeshVertex& v) {
    if (2 * scene_.positions.size() >= slots_.size()) grow();
    for (size_t i = hashOf(v);; ++i) {
      uint32_t& slot = slots_[i & (slots_.size() - 1)];
      if (slot == kNone) {
        slot = static_cast<uint32_t>(scene_.positions.size());
        scene_.positions.push_back(v.position);
        scene_.normals.push_back(v.normal);
        scene_.uvs.push_back(v.uv);
        if (lightmapUvs_) scene_.lightmapUvs.push_back(v.lightmapUv);
        return slot;
      }
      const MeshVertex other = at(slot);
      if (std::memcmp(&other, &v, sizeof v) == 0) return slot;
    }
  }

 private:
  MeshVertex at(uint32_t i) const {
    return {scene_.positions[i], scene_.normals[i], scene_.uvs[i], lightmapUvs_ ? scene_.lightmapUvs[i] : vec2(0.0f)};
  }
  static size_t hashOf(const MeshVertex& v) {
    uint32_t words[sizeof(MeshVertex) / 4];
    std::memcpy(words, &v, sizeof v);
    uint64_t h = 0x9e3779b97f4a7c15u;
    for (const uint32_t w : words) h = (h ^ w) * 0xff51afd7ed558ccdu, h ^= h >> 32;
    return static_cast<size_t>(h);
  }
  void grow() {
    slots_.assign(2 * slots_.size(), kNone);
    for (uint32_t v = 0; v < scene_.positions.size(); ++v) {
      size_t i = hashOf(at(v));
      while (slots_[i & (slots_.size() - 1)] != kNone) ++i;
      slots_[i & (slots_.size() - 1)] = v;
    }
  }

  Scene& scene_;
  bool lightmapUvs_;
  std::vector<uint32_t> slots_;
};
static_assert(sizeof(MeshVertex) == 40, "the bits are compared: no padding");

}  // namespace hl
