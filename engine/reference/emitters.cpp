#include "engine/reference/emitters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace hl {
namespace {

/// The corners, first the least: equal for triangles that coincide and face the same way.
std::array<float, 9> cornerKey(const vec3& a, const vec3& b, const vec3& c) {
  const std::array<float, 9> turns[3] = {{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z},
                                         {b.x, b.y, b.z, c.x, c.y, c.z, a.x, a.y, a.z},
                                         {c.x, c.y, c.z, a.x, a.y, a.z, b.x, b.y, b.z}};
  return std::min({turns[0], turns[1], turns[2]});
}

}  // namespace

Emitters::Emitters(const Scene& scene) {
  std::map<std::array<float, 9>, uint32_t> seen;
  std::vector<double> weights;
  for (uint32_t t = 0; t < scene.indices.size(); ++t) {
    const Material& m = scene.materials[scene.materialIds[t]];
    if (m.emission == vec3(0.0f)) continue;
    const uvec3 i = scene.indices[t];
    Emitter e;
    e.p0 = scene.positions[i.x], e.p1 = scene.positions[i.y], e.p2 = scene.positions[i.z];
    const vec3 cross = glm::cross(e.p1 - e.p0, e.p2 - e.p0);
    const float twiceArea = glm::length(cross);
    if (!(twiceArea > 0)) continue;
    e.normal = cross / twiceArea;
    e.emission = m.emission;
    if (ofTriangle_.empty()) ofTriangle_.assign(scene.indices.size(), kNone);
    const auto [at, isNew] = seen.try_emplace(cornerKey(e.p0, e.p1, e.p2), static_cast<uint32_t>(emitters_.size()));
    ofTriangle_[t] = at->second;
    if (!isNew) continue;
    // A cut-out emitter has holes that a light sample would not see, and an infinite one would take all the probability: rays find those.
    const bool chosen = m.alphaCutoff <= 0 || m.albedoTexture == kNone;
    const double weight = static_cast<double>(twiceArea) * static_cast<double>(luminance(glm::max(m.emission, vec3(0.0f))));
    weights.push_back(chosen && std::isfinite(weight) ? weight : 0.0);
    emitters_.push_back(e);
  }
  double total = 0;
  for (const double w : weights) total += w;
  any_ = total > 0;
  double sum = 0;
  float before = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    const float upTo = any_ ? static_cast<float>(sum / total) : 0.0f;
    // What `choose` really does in single precision, not what it was meant to do.
    emitters_[i].probability = upTo - before;
    cumulative_.push_back(upTo);
    before = upTo;
  }
}

uint32_t Emitters::choose(float u) const {
  if (!any_) return kNone;
  const auto at = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
  return at == cumulative_.end() ? kNone : static_cast<uint32_t>(at - cumulative_.begin());
}

}  // namespace hl
