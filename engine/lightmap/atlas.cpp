#include "engine/lightmap/atlas.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <unordered_map>

#include "engine/lightmap/charts.h"
#include "engine/lightmap/coverage.h"
#include "engine/lightmap/open_part.h"
#include "engine/lightmap/pack.h"

namespace hl {
namespace {

constexpr float kUvSlack = 1e-4f;         ///< how far outside [0, 1] a file's coordinates may lie, as rounding
constexpr double kMaxUvUncovered = 1e-3;  ///< share of the area that a file's coordinates may leave without texels
constexpr double kExpectedCoverage = 0.6;

double sceneArea(const Scene& scene) {
  double area = 0;
  for (const uvec3 i : scene.indices) {
    const glm::dvec3 a(scene.positions[i.x]);
    area += 0.5 * glm::length(glm::cross(glm::dvec3(scene.positions[i.y]) - a, glm::dvec3(scene.positions[i.z]) - a));
  }
  return area;
}

std::vector<vec2> perCorner(const Scene& scene, const std::vector<vec2>& perVertex) {
  std::vector<vec2> corners(3 * scene.triangles());
  for (size_t t = 0; t < scene.triangles(); ++t)
    for (int c = 0; c < 3; ++c) corners[3 * t + static_cast<size_t>(c)] = perVertex[scene.indices[t][c]];
  return corners;
}

bool insideUnitSquare(std::vector<vec2>& uvs) {
  for (vec2& uv : uvs) {
    if (!(uv.x >= -kUvSlack && uv.x <= 1 + kUvSlack && uv.y >= -kUvSlack && uv.y <= 1 + kUvSlack)) return false;
    uv = glm::clamp(uv, vec2(0.0f), vec2(1.0f));
  }
  return true;
}

/// A corner's place in the world and in the lightmap, to the bit. By the one alone, surfaces that merely touch in the lightmap would be one chart.
struct CornerKey {
  std::array<uint32_t, 5> bits;
  bool operator==(const CornerKey&) const = default;
};
struct CornerHash {
  size_t operator()(const CornerKey& k) const {
    uint64_t h = 0x9e3779b97f4a7c15ull;
    for (uint32_t v : k.bits) h = (h ^ v) * 0xff51afd7ed558ccdull, h ^= h >> 32;
    return static_cast<size_t>(h);
  }
};

/// Triangles that share an edge both in the world and in the lightmap are of one chart.
std::vector<uint32_t> chartsByUv(const Scene& scene, const std::vector<vec2>& uvs, uint32_t* count) {
  const auto triangles = static_cast<uint32_t>(uvs.size() / 3);
  std::vector<uint32_t> parent(triangles);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  std::unordered_map<CornerKey, uint32_t, CornerHash> numbers;
  numbers.reserve(uvs.size());
  const auto numberOf = [&](uint32_t t, uint32_t c) {
    const vec3 p = scene.positions[scene.indices[t][static_cast<int>(c)]];
    const vec2 uv = uvs[3 * t + c];
    CornerKey key{};
    size_t i = 0;
    for (float f : {p.x, p.y, p.z, uv.x, uv.y}) key.bits[i++] = std::bit_cast<uint32_t>(f + 0.0f);  // -0 becomes 0
    return numbers.try_emplace(key, static_cast<uint32_t>(numbers.size())).first->second;
  };
  struct Edge {
    std::array<uint32_t, 2> ends;
    uint32_t triangle;
  };
  std::vector<Edge> edges(uvs.size());
  for (uint32_t t = 0; t < triangles; ++t) {
    const std::array<uint32_t, 3> corner{numberOf(t, 0), numberOf(t, 1), numberOf(t, 2)};
    for (uint32_t c = 0; c < 3; ++c) {
      const uint32_t a = corner[c], b = corner[(c + 1) % 3];
      edges[3 * t + c] = {{std::min(a, b), std::max(a, b)}, t};
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.ends != b.ends ? a.ends < b.ends : a.triangle < b.triangle; });
  for (size_t i = 1; i < edges.size(); ++i) {
    if (edges[i].ends != edges[i - 1].ends) continue;
    const uint32_t a = root(edges[i].triangle), b = root(edges[i - 1].triangle);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<uint32_t> charts(triangles), number(triangles, kNone);
  *count = 0;
  for (uint32_t t = 0; t < triangles; ++t) {
    uint32_t& n = number[root(t)];
    if (n == kNone) n = (*count)++;
    charts[t] = n;
  }
  return charts;
}

struct Layout {
  std::vector<vec2> uvs;
  std::vector<uint8_t> unplaced;  ///< empty, or one a triangle
  std::vector<uint32_t> charts;
  Coverage coverage;
  AtlasReport report;
};

/// The file's own coordinates, where they are a lightmap: within the unit square, everything covered, next to no overlaps.
std::optional<Layout> layoutFromUvs(const Scene& scene, const std::vector<vec2>& perVertex, const AtlasSettings& settings, TaskPool& pool, Progress& progress) {
  if (perVertex.size() != scene.positions.size() || perVertex.empty()) return std::nullopt;
  Layout layout;
  layout.uvs = perCorner(scene, perVertex);
  if (!insideUnitSquare(layout.uvs)) return std::nullopt;
  layout.coverage = coverTexels(scene, layout.uvs, {}, settings.resolution, pool, progress);
  const auto covered = static_cast<double>(layout.coverage.lumels.size());
  if (static_cast<double>(layout.coverage.overlapping) > static_cast<double>(settings.uvOverlapTolerance) * covered) return std::nullopt;
  if (layout.coverage.uncoveredArea > kMaxUvUncovered * layout.coverage.area) return std::nullopt;
  if (layout.coverage.flatArea > kMaxUvUncovered * layout.coverage.area) return std::nullopt;
  layout.charts = chartsByUv(scene, layout.uvs, &layout.report.charts);
  return layout;
}

Layout layoutFromCharts(const Scene& scene, const AtlasSettings& settings, TaskPool& pool, Progress& progress) {
  Layout layout;
  const double area = sceneArea(scene);
  const double density = area > 0 ? settings.resolution * std::sqrt(kExpectedCoverage / area) : 1;
  const ChartSet set = makeCharts(scene, density, progress);
  std::vector<glm::dvec2> sizes;
  sizes.reserve(set.charts.size());
  for (const Chart& chart : set.charts) sizes.push_back(chart.size);
  const Packing packing = packRectangles(sizes, settings.resolution, settings.margin, progress);
  layout.uvs.assign(3 * scene.triangles(), vec2(0.0f));
  layout.unplaced.assign(scene.triangles(), 0);
  layout.charts = set.chartOfTriangle;
  for (size_t t = 0; t < scene.triangles(); ++t) {
    const uint32_t chart = set.chartOfTriangle[t];
    if (chart == kNone || !packing.placements[chart].placed) {
      layout.unplaced[t] = 1;
      continue;
    }
    const Placement& p = packing.placements[chart];
    for (size_t c = 0; c < 3; ++c)
      layout.uvs[3 * t + c] = vec2((p.origin + set.corners[3 * t + c] * p.scale) / static_cast<double>(settings.resolution));
  }
  layout.coverage = coverTexels(scene, layout.uvs, layout.unplaced, settings.resolution, pool, progress);
  layout.report.ownCharts = true;
  layout.report.charts = static_cast<uint32_t>(set.charts.size());
  layout.report.margin = packing.margin;
  for (const Placement& p : packing.placements) layout.report.droppedCharts += !p.placed;
  return layout;
}

Layout chooseLayout(const Scene& scene, const AtlasSettings& settings, TaskPool& pool, Progress& progress) {
  if (auto own = layoutFromUvs(scene, scene.lightmapUvs, settings, pool, progress)) return std::move(*own);
  if (scene.hasUvs && scene.lightmapUvs.empty()) {
    if (auto only = layoutFromUvs(scene, scene.uvs, settings, pool, progress)) return std::move(*only);
  }
  return layoutFromCharts(scene, settings, pool, progress);
}

}  // namespace

Atlas buildAtlas(const Scene& scene, const AtlasSettings& settings, TaskPool& pool, Progress& progress, const FindInside& findInside) {
  progress.begin("lightmap atlas", static_cast<uint64_t>(settings.resolution + 7) / 8);
  Layout layout = chooseLayout(scene, settings, pool, progress);
  Coverage& coverage = layout.coverage;
  std::vector<uint8_t> inside(coverage.lumels.size(), 0);
  if (findInside && !coverage.lumels.empty()) {
    findInside(coverage.lumels, inside);
    progress.check();
    layout.report.openedTexels = openCoveredTexels(scene, layout.uvs, settings.resolution, coverage.lumels, inside, findInside, progress);
  }
  progress.check();

  Atlas atlas;
  const auto texels = static_cast<size_t>(settings.resolution) * static_cast<size_t>(settings.resolution);
  atlas.resolution = settings.resolution;
  atlas.cornerUvs = std::move(layout.uvs);
  atlas.charts = std::move(layout.charts);
  atlas.lumelOfTexel.assign(texels, kNone);
  atlas.texelState.assign(texels, TexelEmpty);
  atlas.report = layout.report;
  for (size_t i = 0; i < coverage.lumels.size(); ++i) {
    const Lumel& lumel = coverage.lumels[i];
    atlas.report.insideTexels += inside[i];
    atlas.texelState[lumel.texel] = inside[i] ? TexelInside : coverage.overlaps[i] ? TexelOverlap : TexelValid;
    if (inside[i]) continue;
    atlas.lumelOfTexel[lumel.texel] = static_cast<uint32_t>(atlas.lumels.size());
    atlas.lumels.push_back(lumel);
  }
  AtlasReport& report = atlas.report;
  report.coveredTexels = coverage.lumels.size();
  report.validTexels = atlas.lumels.size();
  report.overlappingTexels = coverage.overlapping;
  report.coverage = static_cast<double>(report.coveredTexels) / static_cast<double>(texels);
  report.densityMean = coverage.densityMean;
  report.densitySpread = coverage.densitySpread;
  report.area = coverage.area;
  report.uncoveredArea = coverage.uncoveredArea;
  return atlas;
}

}  // namespace hl
