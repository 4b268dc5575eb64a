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
    e.area = 0.5f * twiceArea;
    e.emission = m.emission;
    if (ofTriangle_.empty()) ofTriangle_.assign(scene.indices.size(), kNone);
    const auto [at, isNew] = seen.try_emplace(cornerKey(e.p0, e.p1, e.p2), static_cast<uint32_t>(emitters_.size()));
    ofTriangle_[t] = at->second;
    if (!isNew) continue;
    // A cut-out emitter has holes that a light sample would not see, and an infinite one would take all the probability: rays find those.
    const bool chosen = m.alphaCutoff <= 0 || m.albedoTexture == kNone;
    const double weight = static_cast<double>(twiceArea) * static_cast<double>(luminance(glm::max(m.emission, vec3(0.0f))));
    weights.push_back(chosen && std::isfinite(weight) ? weight : 0.0);
    e.luminance = weights.back() > 0 ? luminance(glm::max(m.emission, vec3(0.0f))) : 0.0f;
    emitters_.push_back(e);
  }
  weighed_ = emitters_.size() <= kMaxWeighedEmitters;
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

EmitterChoice Emitters::weigh(vec3 from, vec3 normal) const {
  EmitterChoice choice;
  if (!weighed_) return choice;
  for (size_t i = 0; i < emitters_.size(); ++i) {
    const Emitter& e = emitters_[i];
    const vec3 a = e.p0 - from, b = e.p1 - from, c = e.p2 - from;
    const float ahead = -glm::dot(a, e.normal);  // how far `from` lies in front of the emitter's plane
    const float height = std::max(glm::dot(a, normal), std::max(glm::dot(b, normal), glm::dot(c, normal)));
    if (e.luminance > 0 && ahead > 0 && height > 0) {
      const vec3 centre = (a + b + c) / 3.0f;
      const float d2 = glm::dot(centre, centre);
      choice.total += e.luminance * std::min(1.0f, e.area * ahead * height / (kPi * d2 * d2));
    }
    choice.cumulative[i] = choice.total;
  }
  return choice;
}

uint32_t Emitters::choose(const EmitterChoice& choice, float u) const {
  if (!any_) return kNone;
  const float* begin = weighed_ ? choice.cumulative.data() : cumulative_.data();
  const float* end = begin + emitters_.size();
  const float* at = std::upper_bound(begin, end, weighed_ ? u * choice.total : u);
  return at == end ? kNone : static_cast<uint32_t>(at - begin);
}

float Emitters::probability(const EmitterChoice& choice, uint32_t i) const {
  if (!weighed_) return emitters_[i].probability;
  if (!(choice.total > 0)) return 0;
  return (choice.cumulative[i] - (i == 0 ? 0.0f : choice.cumulative[i - 1])) / choice.total;
}

}  // namespace hl
