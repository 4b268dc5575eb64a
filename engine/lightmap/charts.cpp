#include "engine/lightmap/charts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <queue>
#include <unordered_map>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/lightmap/raster.h"

namespace hl {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kGrowCosine = 0.64;      ///< 50 degrees between a triangle's normal and its chart's mean normal while growing
constexpr double kProjectCosine = 0.34;   ///< 70 degrees: what a finished chart may have; beyond that the projection would squeeze the triangle
constexpr double kSparse = 0.4;           ///< charts that fill less of their rectangle are cut in two
constexpr double kSparseMinTexels = 12;   ///< unless they are shorter than this
constexpr double kOverlapSamples = 4;     ///< a texel's side, in the search for charts that overlap themselves
constexpr double kMaxOverlapSamples = 3.2e7;  ///< of one chart: a thin ring has next to no area and a huge rectangle
constexpr uint64_t kCheckEvery = 4096;

struct Triangle {
  dvec3 normal{0.0};
  double area = 0;
  std::array<uint32_t, 3> vertices{};   ///< welded
  std::array<uint32_t, 3> neighbours{kNone, kNone, kNone};
};

struct PositionHash {
  size_t operator()(const std::array<uint32_t, 3>& p) const {
    uint64_t h = 0x9e3779b97f4a7c15ull;
    for (uint32_t v : p) h = (h ^ v) * 0xff51afd7ed558ccdull, h ^= h >> 32;
    return static_cast<size_t>(h);
  }
};

/// Vertices with the same position are one: files split them along texture seams and smoothing groups.
std::vector<uint32_t> weld(const Scene& scene) {
  std::unordered_map<std::array<uint32_t, 3>, uint32_t, PositionHash> first;
  first.reserve(scene.positions.size());
  std::vector<uint32_t> welded(scene.positions.size());
  for (size_t i = 0; i < scene.positions.size(); ++i) {
    const vec3 p = scene.positions[i] + vec3(0.0f);  // -0 becomes 0
    const std::array<uint32_t, 3> key{std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z)};
    welded[i] = first.try_emplace(key, static_cast<uint32_t>(i)).first->second;
  }
  return welded;
}

class ChartMaker {
 public:
  ChartMaker(const Scene& scene, double texelsPerMetre, Progress& progress) : scene_(scene), density_(texelsPerMetre), progress_(progress) {}

  ChartSet run() {
    measureTriangles();
    findNeighbours();
    set_.corners.resize(3 * triangles_.size());
    set_.chartOfTriangle.assign(triangles_.size(), kNone);
    std::vector<uint32_t> order;
    for (uint32_t t = 0; t < triangles_.size(); ++t)
      if (triangles_[t].area > 0) order.push_back(t);
    // The largest first: walls and floors become whole charts before their trimmings claim parts of them.
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return triangles_[a].area > triangles_[b].area; });
    owner_.assign(triangles_.size(), kNone);
    while (!order.empty()) {
      std::vector<uint32_t> left;
      for (uint32_t seed : order)
        if (owner_[seed] == kNone) finish(grow(seed), left);
      for (uint32_t t : left) owner_[t] = kNone;
      std::stable_sort(left.begin(), left.end(), [&](uint32_t a, uint32_t b) { return triangles_[a].area > triangles_[b].area; });
      order = std::move(left);
    }
    return std::move(set_);
  }

 private:
  void check() {
    if (++steps_ % kCheckEvery == 0) progress_.check();
  }

  void measureTriangles() {
    const std::vector<uint32_t> welded = weld(scene_);
    triangles_.resize(scene_.triangles());
    for (size_t t = 0; t < triangles_.size(); ++t) {
      const uvec3 i = scene_.indices[t];
      const dvec3 a(scene_.positions[i.x]), b(scene_.positions[i.y]), c(scene_.positions[i.z]);
      const dvec3 n = glm::cross(b - a, c - a);
      const double length = glm::length(n);
      Triangle& triangle = triangles_[t];
      triangle.vertices = {welded[i.x], welded[i.y], welded[i.z]};
      if (!(length > 0)) continue;
      triangle.area = 0.5 * length;
      triangle.normal = n / length;
    }
    progress_.check();
  }

  /// Across edges that exactly two triangles share, wound the same way round, and on the same side of what emits light.
  void findNeighbours() {
    struct HalfEdge {
      uint32_t low, high, triangle;
      uint8_t edge;
      bool forward;
    };
    std::vector<HalfEdge> edges;
    edges.reserve(3 * triangles_.size());
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!(triangles_[t].area > 0)) continue;
      for (uint8_t e = 0; e < 3; ++e) {
        const uint32_t a = triangles_[t].vertices[e], b = triangles_[t].vertices[(e + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t, e, a < b});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
      if (a.low != b.low) return a.low < b.low;
      if (a.high != b.high) return a.high < b.high;
      return a.triangle < b.triangle;
    });
    for (size_t i = 0; i < edges.size();) {
      size_t end = i + 1;
      while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
      if (end - i == 2) {
        const HalfEdge &a = edges[i], &b = edges[i + 1];
        if (a.forward != b.forward && emits(a.triangle) == emits(b.triangle)) {
          triangles_[a.triangle].neighbours[a.edge] = b.triangle;
          triangles_[b.triangle].neighbours[b.edge] = a.triangle;
        }
      }
      i = end;
    }
    progress_.check();
  }

  bool emits(uint32_t t) const {
    const vec3 e = scene_.materials[scene_.materialIds[t]].emission;
    return e.x > 0 || e.y > 0 || e.z > 0;
  }

  /// From the seed outwards, flattest neighbour first, in the order in which triangles joined.
  std::vector<uint32_t> grow(uint32_t seed) {
    struct Candidate {
      double deviation;
      uint32_t triangle;
      bool operator<(const Candidate& o) const {
        return deviation != o.deviation ? deviation > o.deviation : triangle > o.triangle;
      }
    };
    std::priority_queue<Candidate> queue;
    std::vector<uint32_t> members;
    dvec3 sum(0.0);
    queue.push({0, seed});
    while (!queue.empty()) {
      check();
      const uint32_t t = queue.top().triangle;
      queue.pop();
      if (owner_[t] != kNone) continue;
      const dvec3 mean = members.empty() ? triangles_[seed].normal : glm::normalize(sum);
      if (glm::dot(mean, triangles_[t].normal) < kGrowCosine || glm::dot(triangles_[seed].normal, triangles_[t].normal) < kProjectCosine)
        continue;
      owner_[t] = seed;
      members.push_back(t);
      sum += triangles_[t].normal * triangles_[t].area;
      for (uint32_t n : triangles_[t].neighbours) {
        if (n != kNone && owner_[n] == kNone) queue.push({1 - glm::dot(mean, triangles_[n].normal), n});
      }
    }
    return members;
  }

  /// Lays the triangles flat; those that would be squeezed or would overlap go to `left`; sparse ones are cut in two.
  void finish(std::vector<uint32_t> members, std::vector<uint32_t>& left) {
    dvec3 normal(0.0);
    for (uint32_t t : members) normal += triangles_[t].normal * triangles_[t].area;
    normal = glm::normalize(normal);
    std::vector<uint32_t> kept;
    for (uint32_t t : members) (glm::dot(normal, triangles_[t].normal) < kProjectCosine ? left : kept).push_back(t);
    if (kept.empty()) {  // cannot be, for the mean lies within the spread; a chart of one triangle always works
      kept = {members.front()};
      left.erase(std::find(left.begin(), left.end(), members.front()));
      normal = triangles_[members.front()].normal;
    }
    project(kept, normal);
    if (kept.size() > 2) kept = withoutOverlaps(kept, left);
    addChart(std::move(kept));
  }

  void project(const std::vector<uint32_t>& members, dvec3 n) {
    const dvec3 axis = std::abs(n.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 tangent = glm::normalize(glm::cross(axis, n)), bitangent = glm::cross(n, tangent);
    const dvec3 origin(scene_.positions[triangles_[members.front()].vertices[0]]);
    for (uint32_t t : members) {
      for (size_t c = 0; c < 3; ++c) {
        const dvec3 p = dvec3(scene_.positions[triangles_[t].vertices[c]]) - origin;
        set_.corners[3 * t + c] = {glm::dot(p, tangent), glm::dot(p, bitangent)};
      }
    }
  }

  /// Draws the triangles in the order of growth and turns away those that meet a point another one owns.
  std::vector<uint32_t> withoutOverlaps(const std::vector<uint32_t>& members, std::vector<uint32_t>& left) {
    dvec2 low(1e300), high(-1e300);
    for (uint32_t t : members) {
      for (size_t c = 0; c < 3; ++c) {
        low = {std::min(low.x, set_.corners[3 * t + c].x), std::min(low.y, set_.corners[3 * t + c].y)};
        high = {std::max(high.x, set_.corners[3 * t + c].x), std::max(high.y, set_.corners[3 * t + c].y)};
      }
    }
    const double room = std::max((high.x - low.x) * (high.y - low.y), 1e-300);
    const double scale = std::min(density_ * kOverlapSamples, std::sqrt(kMaxOverlapSamples / room));
    const auto columns = static_cast<int64_t>((high.x - low.x) * scale) + 1, rows = static_cast<int64_t>((high.y - low.y) * scale) + 1;
    drawn_.assign(static_cast<size_t>(columns * rows), 0);
    std::vector<uint32_t> kept;
    std::vector<size_t> owned;
    for (uint32_t t : members) {
      check();
      dvec2 p[3], a(1e300), b(-1e300);
      for (size_t c = 0; c < 3; ++c) {
        p[c] = (set_.corners[3 * t + c] - low) * scale;
        a = {std::min(a.x, p[c].x), std::min(a.y, p[c].y)};
        b = {std::max(b.x, p[c].x), std::max(b.y, p[c].y)};
      }
      const OwnershipTest test(p[0], p[1], p[2]);
      owned.clear();
      bool overlaps = false;
      for (auto y = static_cast<int64_t>(a.y); y <= std::min<int64_t>(rows - 1, static_cast<int64_t>(b.y)) && !overlaps; ++y) {
        for (auto x = static_cast<int64_t>(a.x); x <= std::min<int64_t>(columns - 1, static_cast<int64_t>(b.x)) && !overlaps; ++x) {
          if (!test.owns({static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5})) continue;
          owned.push_back(static_cast<size_t>(y * columns + x));
          overlaps = drawn_[owned.back()] != 0;
        }
      }
      if (overlaps) {
        left.push_back(t);
        continue;
      }
      for (size_t i : owned) drawn_[i] = 1;
      kept.push_back(t);
    }
    return kept;
  }

  /// Turned to its smallest rectangle; cut in two along the longer side while it leaves most of the rectangle empty.
  void addChart(std::vector<uint32_t> members) {
    const dvec2 size = turn(members);
    double area = 0, flat = 0;
    for (uint32_t t : members) {
      area += triangles_[t].area;
      const dvec2* p = &set_.corners[3 * t];
      flat += 0.5 * std::abs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x));
    }
    if (members.size() > 1 && flat < kSparse * size.x * size.y && size.x * density_ > kSparseMinTexels) {
      // At the mean of the middles: long triangles reach across the rectangle's own middle and would all stay together.
      const auto middle = [&](uint32_t t) { return set_.corners[3 * t].x + set_.corners[3 * t + 1].x + set_.corners[3 * t + 2].x; };
      double mean = 0;
      for (uint32_t t : members) mean += middle(t) / static_cast<double>(members.size());
      std::vector<uint32_t> halves[2];
      for (uint32_t t : members) halves[middle(t) > mean].push_back(t);
      if (!halves[0].empty() && !halves[1].empty()) {
        addChart(std::move(halves[0]));
        addChart(std::move(halves[1]));
        return;
      }
    }
    for (uint32_t t : members) set_.chartOfTriangle[t] = static_cast<uint32_t>(set_.charts.size());
    set_.charts.push_back({std::move(members), size, area});
  }

  dvec2 turn(const std::vector<uint32_t>& members) {
    std::vector<dvec2> hull;
    hull.reserve(3 * members.size());
    for (uint32_t t : members)
      for (size_t c = 0; c < 3; ++c) hull.push_back(set_.corners[3 * t + c]);
    hull = convexHull(std::move(hull));
    double best = 1e300;
    dvec2 axis(1, 0), low(0.0), size(0.0);
    for (size_t i = 0; i < hull.size(); ++i) {
      const dvec2 edge = hull[(i + 1) % hull.size()] - hull[i];
      const double length = glm::length(edge);
      if (!(length > 0)) continue;
      const dvec2 u = edge / length, v(-u.y, u.x);
      dvec2 a(1e300), b(-1e300);
      for (dvec2 p : hull) {
        const dvec2 q(glm::dot(p, u), glm::dot(p, v));
        a = {std::min(a.x, q.x), std::min(a.y, q.y)};
        b = {std::max(b.x, q.x), std::max(b.y, q.y)};
      }
      // A relative margin, so that rounding does not choose between the equal sides of a rectangle.
      const double rectangle = (b.x - a.x) * (b.y - a.y);
      if (rectangle < best * (1 - 1e-9)) best = rectangle, axis = u, low = a, size = b - a;
    }
    const bool tall = size.y > size.x;
    for (uint32_t t : members) {
      for (size_t c = 0; c < 3; ++c) {
        dvec2& p = set_.corners[3 * t + c];
        const dvec2 q(glm::dot(p, axis) - low.x, glm::dot(p, dvec2(-axis.y, axis.x)) - low.y);
        p = tall ? dvec2(q.y, size.x - q.x) : q;
        p = {std::clamp(p.x, 0.0, tall ? size.y : size.x), std::clamp(p.y, 0.0, tall ? size.x : size.y)};
      }
    }
    return tall ? dvec2(size.y, size.x) : size;
  }

  /// Andrew's monotone chain.
  static std::vector<dvec2> convexHull(std::vector<dvec2> points) {
    std::sort(points.begin(), points.end(), [](dvec2 a, dvec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    points.erase(std::unique(points.begin(), points.end(), [](dvec2 a, dvec2 b) { return a.x == b.x && a.y == b.y; }), points.end());
    if (points.size() < 3) return points;
    const auto turns = [](dvec2 a, dvec2 b, dvec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); };
    std::vector<dvec2> hull(2 * points.size());
    size_t n = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      while (n >= 2 && turns(hull[n - 2], hull[n - 1], points[i]) <= 0) --n;
      hull[n++] = points[i];
    }
    const size_t lower = n + 1;
    for (size_t i = points.size() - 1; i-- > 0;) {
      while (n >= lower && turns(hull[n - 2], hull[n - 1], points[i]) <= 0) --n;
      hull[n++] = points[i];
    }
    hull.resize(n - 1);
    return hull;
  }

  const Scene& scene_;
  double density_;
  Progress& progress_;
  uint64_t steps_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<uint32_t> owner_;
  std::vector<uint8_t> drawn_;
  ChartSet set_;
};

}  // namespace

ChartSet makeCharts(const Scene& scene, double texelsPerMetre, Progress& progress) {
  return ChartMaker(scene, texelsPerMetre, progress).run();
}

}  // namespace hl
