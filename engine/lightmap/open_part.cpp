#include "engine/lightmap/open_part.h"

#include <algorithm>

#include <glm/geometric.hpp>

namespace hl {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int kSide = 4;  ///< points a texel and side

/// Surface points of the texel, on a grid, as far as its lumel's triangle holds them.
std::vector<vec3> pointsOf(const Scene& scene, const std::vector<vec2>& uvs, int resolution, const Lumel& lumel) {
  const size_t t = lumel.triangle;
  const double side = resolution;
  const dvec2 a = dvec2(uvs[3 * t]) * side, b = dvec2(uvs[3 * t + 1]) * side - a, c = dvec2(uvs[3 * t + 2]) * side - a;
  const double doubled = b.x * c.y - b.y * c.x;
  std::vector<vec3> points;
  if (doubled == 0) return points;
  const uvec3 i = scene.indices[t];
  const dvec3 p0(scene.positions[i.x]), p1(scene.positions[i.y]), p2(scene.positions[i.z]);
  const dvec2 corner(lumel.texel % static_cast<uint32_t>(resolution), lumel.texel / static_cast<uint32_t>(resolution));
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const dvec2 d = corner + dvec2(x + 0.5, y + 0.5) / static_cast<double>(kSide) - a;
      const double v = (d.x * c.y - d.y * c.x) / doubled, w = (b.x * d.y - b.y * d.x) / doubled;
      if (v >= 0 && w >= 0 && v + w <= 1) points.push_back(vec3(p0 * (1 - v - w) + p1 * v + p2 * w));
    }
  return points;
}

/// Lumels that have one of the other kind among the eight round them.
std::vector<size_t> atTheRim(const std::vector<Lumel>& lumels, const std::vector<uint8_t>& inside, int resolution) {
  constexpr uint8_t kOpen = 1, kCovered = 2;
  std::vector<uint8_t> kind(static_cast<size_t>(resolution) * static_cast<size_t>(resolution), 0);
  for (size_t i = 0; i < lumels.size(); ++i) kind[lumels[i].texel] = inside[i] ? kCovered : kOpen;
  std::vector<size_t> rim;
  for (size_t i = 0; i < lumels.size(); ++i) {
    const int x = static_cast<int>(lumels[i].texel) % resolution, y = static_cast<int>(lumels[i].texel) / resolution;
    uint8_t round = 0;
    for (int v = std::max(0, y - 1); v <= std::min(resolution - 1, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(resolution - 1, x + 1); ++u)
        round |= kind[static_cast<size_t>(v) * static_cast<size_t>(resolution) + static_cast<size_t>(u)];
    if (round == (kOpen | kCovered)) rim.push_back(i);
  }
  return rim;
}

}  // namespace

uint64_t openCoveredTexels(const Scene& scene, const std::vector<vec2>& cornerUvs, int resolution, std::vector<Lumel>& lumels, std::vector<uint8_t>& inside,
                           const FindInside& findInside, Progress& progress) {
  const std::vector<size_t> rim = atTheRim(lumels, inside, resolution);
  std::vector<Lumel> points;
  std::vector<size_t> firstOf;
  for (const size_t i : rim) {
    firstOf.push_back(points.size());
    for (const vec3& p : pointsOf(scene, cornerUvs, resolution, lumels[i])) points.push_back(lumels[i]), points.back().position = p;
  }
  firstOf.push_back(points.size());
  if (points.empty()) return 0;
  progress.check();
  std::vector<uint8_t> covered;
  findInside(points, covered);

  std::vector<Lumel> means;
  std::vector<size_t> whose;
  for (size_t k = 0; k < rim.size(); ++k) {
    const size_t count = firstOf[k + 1] - firstOf[k];
    dvec3 sum(0.0);
    size_t open = 0;
    for (size_t j = firstOf[k]; j < firstOf[k + 1]; ++j)
      if (!covered[j]) sum += dvec3(points[j].position), ++open;
    if (open == 0 || open == count) continue;
    Lumel mean = lumels[rim[k]];
    mean.position = vec3(sum / static_cast<double>(open));
    // Of a texel that holds other triangles too (or nothing) the share is not known.
    if (count == size_t{kSide * kSide}) mean.area *= static_cast<float>(open) / static_cast<float>(count);
    means.push_back(mean);
    whose.push_back(k);
  }
  if (means.empty()) return 0;
  progress.check();
  std::vector<uint8_t> meanCovered;
  findInside(means, meanCovered);
  uint64_t opened = 0;
  for (size_t m = 0; m < means.size(); ++m) {
    const size_t k = whose[m];
    Lumel& lumel = lumels[rim[k]];
    const vec3 mean = means[m].position;
    lumel = means[m];
    opened += inside[rim[k]];
    inside[rim[k]] = 0;
    if (!meanCovered[m]) continue;
    float nearest = -1;
    for (size_t j = firstOf[k]; j < firstOf[k + 1]; ++j) {
      const vec3 off = points[j].position - mean;
      if (covered[j] || (nearest >= 0 && glm::dot(off, off) >= nearest)) continue;
      nearest = glm::dot(off, off);
      lumel.position = points[j].position;
    }
  }
  return opened;
}

}  // namespace hl
