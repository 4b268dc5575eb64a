#include "engine/lightmap/tables.h"

#include <cmath>

#include "shaders/shared/lightmap_codes.h"

namespace hl {
namespace {

vec2 encodeOctahedral(vec3 n) {
  n /= std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (n.z >= 0) return vec2(n.x, n.y);
  return vec2((1 - std::abs(n.y)) * (n.x >= 0 ? 1.0f : -1.0f), (1 - std::abs(n.x)) * (n.y >= 0 ? 1.0f : -1.0f));
}

std::vector<vec4> packTriangles(const Scene& scene, const Atlas& atlas) {
  std::vector<vec4> packed(2 * scene.triangles(), vec4(0.0f));
  for (size_t t = 0; t < scene.triangles(); ++t) {
    const uvec3 i = scene.indices[t];
    const glm::dvec3 p(scene.positions[i.x]);
    const glm::dvec3 n = glm::cross(glm::dvec3(scene.positions[i.y]) - p, glm::dvec3(scene.positions[i.z]) - p);
    const double length = glm::length(n);
    const vec2 normal = length > 0 ? encodeOctahedral(vec3(n / length)) : vec2(0.0f);
    const vec2 a = atlas.cornerUvs[3 * t], u = atlas.cornerUvs[3 * t + 1] - a, v = atlas.cornerUvs[3 * t + 2] - a;
    packed[2 * t] = vec4(a.x, a.y, u.x, u.y);
    packed[2 * t + 1] = vec4(v.x, v.y, normal.x, normal.y);
  }
  return packed;
}

/// Texels next to each other, those that share a side first.
constexpr int kNeighbours[8][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

/// Calls found(texel, neighbour) for each of the texel's neighbours inside the map.
template <class Found>
void forNeighbours(int resolution, size_t texel, Found found) {
  const int x = static_cast<int>(texel % static_cast<size_t>(resolution)), y = static_cast<int>(texel / static_cast<size_t>(resolution));
  for (const auto& [dx, dy] : kNeighbours) {
    const int u = x + dx, v = y + dy;
    if (u >= 0 && v >= 0 && u < resolution && v < resolution) found(static_cast<size_t>(v) * resolution + static_cast<size_t>(u));
  }
}

/// Each ring from the ring before, never in place: a texel's value depends on its distance alone, not on the order of the loop.
template <class Step>
void spread(std::vector<uint32_t>& table, int rings, const Step& step, Progress& progress) {
  for (int ring = 0; ring < rings; ++ring) {
    progress.check();
    std::vector<uint32_t> next = table;
    for (size_t i = 0; i < table.size(); ++i) next[i] = step(i);
    table.swap(next);
  }
}

}  // namespace

LightmapTables makeLightmapTables(const Scene& scene, const Atlas& atlas, int dilation, Progress& progress) {
  LightmapTables tables;
  tables.triangles = packTriangles(scene, atlas);
  tables.reflectance.reserve(atlas.lumels.size());
  for (const Lumel& l : atlas.lumels) tables.reflectance.push_back(vec4(l.albedo / kPi, l.area));

  tables.lumelOfTexel = atlas.lumelOfTexel;
  tables.chartOfTexel.assign(atlas.lumelOfTexel.size(), shared::kNoChart);
  for (const Lumel& l : atlas.lumels) tables.chartOfTexel[l.texel] = atlas.charts[l.triangle];
  static_assert(kNone == shared::kNoLumel);

  std::vector<uint32_t>& lumels = tables.lumelOfTexel;
  spread(
      lumels, kBorrowReach,
      [&](size_t i) {
        uint32_t found = lumels[i];
        if (found != kNone) return found;
        forNeighbours(atlas.resolution, i, [&](size_t n) {
          if (found == kNone && lumels[n] != kNone) found = lumels[n] | shared::kBorrowed;
        });
        return found;
      },
      progress);
  std::vector<uint32_t>& charts = tables.chartOfTexel;
  spread(
      charts, dilation,
      [&](size_t i) {
        uint32_t found = charts[i];
        if (found != shared::kNoChart) return found;
        forNeighbours(atlas.resolution, i, [&](size_t n) {
          if (charts[n] == shared::kNoChart || charts[n] == found) return;
          found = found == shared::kNoChart ? charts[n] : shared::kMixedChart;
        });
        return found;
      },
      progress);
  return tables;
}

std::vector<shared::SurfacePoint> lumelPoints(const Atlas& atlas, float offset) {
  std::vector<shared::SurfacePoint> points;
  points.reserve(atlas.lumels.size());
  for (const Lumel& l : atlas.lumels) points.push_back({l.position, offset, l.normal, 0, l.normal, l.triangle});
  return points;
}

}  // namespace hl
