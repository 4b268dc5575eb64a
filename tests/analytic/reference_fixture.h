#pragma once
// Small closed scenes with known answers, and what a reference run says about them.
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/reference/reference.h"
#include "engine/scene/scene.h"
#include "engine/trace/embree_scene.h"
#include "shaders/shared/sampling.h"

namespace hl::test {

struct Estimate {
  double value = 0, error = 0;  ///< mean and its standard error
};

inline uint32_t addMaterial(Scene& s, vec3 albedo, vec3 emission = vec3(0.0f), bool twoSided = false) {
  Material m;
  m.albedo = albedo, m.emission = emission, m.twoSided = twoSided;
  s.materials.push_back(m);
  return static_cast<uint32_t>(s.materials.size() - 1);
}

inline void addTriangle(Scene& s, vec3 a, vec3 b, vec3 c, uint32_t material, vec3 na, vec3 nb, vec3 nc) {
  const uint32_t i = static_cast<uint32_t>(s.positions.size());
  for (const vec3& p : {a, b, c}) s.positions.push_back(p), s.bounds.extend(p);
  for (const vec3& n : {na, nb, nc}) s.normals.push_back(n), s.uvs.push_back(vec2(0.0f));
  s.indices.push_back(uvec3(i, i + 1, i + 2));
  s.materialIds.push_back(material), s.objectIds.push_back(0);
}

/// Parallelogram whose front is the side of cross(e1, e2).
inline void addQuad(Scene& s, vec3 corner, vec3 e1, vec3 e2, uint32_t material) {
  const vec3 n = glm::normalize(glm::cross(e1, e2));
  addTriangle(s, corner, corner + e1, corner + e1 + e2, material, n, n, n);
  addTriangle(s, corner, corner + e1 + e2, corner + e2, material, n, n, n);
  const size_t v = s.uvs.size() - 6;
  s.uvs[v + 1] = s.uvs[v + 5] = vec2(0.0f);
  s.uvs[v + 1] = vec2(1, 0), s.uvs[v + 2] = vec2(1, 1), s.uvs[v + 4] = vec2(1, 1), s.uvs[v + 5] = vec2(0, 1);
}

/// A box [min, max] seen from inside; `material` by face: -x, +x, -y, +y, -z, +z.
inline void addRoom(Scene& s, vec3 min, vec3 max, const std::function<uint32_t(int)>& material) {
  const vec3 d = max - min, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  addQuad(s, min, y, z, material(0));
  addQuad(s, min + x, z, y, material(1));
  addQuad(s, min, z, x, material(2));
  addQuad(s, min + y, x, z, material(3));
  addQuad(s, min, x, y, material(4));
  addQuad(s, min + z, y, x, material(5));
}
inline void addRoom(Scene& s, vec3 min, vec3 max, uint32_t material) {
  addRoom(s, min, max, [material](int) { return material; });
}

/// A sphere of latitude and longitude facets; its front is inside. Flat: the facets' own normals.
inline void addSphereFromInside(Scene& s, float radius, int rows, uint32_t material) {
  const auto at = [&](int i, int j) {
    const float theta = kPi * static_cast<float>(i) / static_cast<float>(rows);
    const float phi = kPi * static_cast<float>(j) / static_cast<float>(rows);
    return radius * vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  const auto facet = [&](vec3 a, vec3 b, vec3 c) {
    const vec3 n = glm::normalize(glm::cross(b - a, c - a));
    addTriangle(s, a, b, c, material, n, n, n);
  };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < 2 * rows; ++j) {
      const vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (i + 1 < rows) facet(a, b, c);
      if (i > 0) facet(a, c, d);
    }
}

inline double surfaceArea(const Scene& s) {
  double a = 0;
  for (const uvec3& t : s.indices)
    a += 0.5 * static_cast<double>(
                   glm::length(glm::cross(s.positions[t.y] - s.positions[t.x], s.positions[t.z] - s.positions[t.x])));
  return a;
}

inline Receiver receiverAt(vec3 position, vec3 normal) {
  Receiver r;
  r.position = position, r.geometricNormal = r.mappedNormal = normal;
  return r;
}

/// Points spread over all of a scene's triangles in proportion to area, on their fronts: the mean over them is the mean over the surface.
inline std::vector<Receiver> receiversOverSurface(const Scene& s, int count) {
  std::vector<double> upTo;
  double area = 0;
  const auto corners = [&](size_t t) {
    const uvec3 i = s.indices[t];
    return std::array<vec3, 3>{s.positions[i.x], s.positions[i.y], s.positions[i.z]};
  };
  for (size_t t = 0; t < s.indices.size(); ++t) {
    const auto p = corners(t);
    upTo.push_back(area += 0.5 * static_cast<double>(glm::length(glm::cross(p[1] - p[0], p[2] - p[0]))));
  }
  std::vector<Receiver> receivers;
  size_t t = 0;
  uint32_t inTriangle = 0;
  for (int i = 0; i < count; ++i) {
    const double target = (i + 0.5) / count * area;
    while (upTo[t] < target && t + 1 < upTo.size()) ++t, inTriangle = 0;
    const uint32_t seed = shared::pcgHash(static_cast<uint32_t>(t));
    const vec2 w = shared::sampleTriangle(shared::sobolPoint(inTriangle++, uvec2(seed, shared::pcgHash(seed))));
    const auto p = corners(t);
    receivers.push_back(receiverAt(p[0] + (p[1] - p[0]) * w.x + (p[2] - p[0]) * w.y,
                                   glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]))));
  }
  return receivers;
}

inline TaskPool& sharedPool() {
  static TaskPool pool;
  return pool;
}

struct Run {
  Scene scene;
  std::shared_ptr<const EmbreeScene> embree;
  std::shared_ptr<const ReferenceResult> result;
};

inline std::shared_ptr<const ReferenceResult> traceAll(ReferenceTracer& tracer) {
  Progress progress;
  while (!tracer.settled()) tracer.advance(progress);
  return tracer.result();
}

inline std::shared_ptr<const ReferenceResult> trace(const Scene& scene, const std::vector<Receiver>& receivers,
                                                    const ReferenceSettings& settings) {
  ReferenceTracer tracer(std::make_shared<EmbreeScene>(scene), receivers, static_cast<int>(receivers.size()), 1,
                         settings, sharedPool());
  return traceAll(tracer);
}

/// Mean luminance of a channel's pixels [first, last) over both halves; the standard error is that of independent pixels and halves, about their own
/// means where `sameEverywhere` (pixels share one truth), else from the halves' differences alone.
inline Estimate meanOf(const ReferenceImage& image, size_t first, size_t last, bool sameEverywhere) {
  const auto at = [](const Image& i, size_t p) { return static_cast<double>(i.data[3 * p + 1]); };
  const double n = static_cast<double>(last - first);
  Estimate e;
  double squares = 0;
  for (size_t p = first; p < last; ++p) e.value += at(image.mean, p) / n;
  for (size_t p = first; p < last; ++p) {
    const double a = at(image.halfA, p), b = at(image.halfB, p);
    squares += sameEverywhere ? (a - e.value) * (a - e.value) + (b - e.value) * (b - e.value) : (a - b) * (a - b);
  }
  // Variance of a pixel's half: of 2n values, or half the mean square difference.
  const double variance = sameEverywhere ? squares / (2 * n - 1) : squares / (2 * n);
  e.error = std::sqrt(variance / (2 * n));
  return e;
}
inline Estimate meanOf(const ReferenceImage& image, bool sameEverywhere = false) {
  return meanOf(image, 0, image.mean.pixels(), sameEverywhere);
}

inline ReferenceImage bucketOf(const ReferenceResult& r, size_t bucket) {
  ReferenceImage i;
  i.halfA = r.indirect[0][bucket], i.halfB = r.indirect[1][bucket];
  i.mean = i.halfA;
  for (size_t k = 0; k < i.mean.data.size(); ++k) i.mean.data[k] = 0.5f * (i.halfA.data[k] + i.halfB.data[k]);
  return i;
}

inline PointLight pointLight(vec3 position, float candela) {
  PointLight l;
  l.position = position, l.intensity = vec3(candela);
  return l;
}

}  // namespace hl::test
