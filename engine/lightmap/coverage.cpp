#include "engine/lightmap/coverage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "engine/lightmap/raster.h"
#include "engine/lightmap/surface_colour.h"

namespace hl {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int kBandRows = 8;             ///< a piece of work: this many rows of texels
constexpr int kSamplesPerSide = 8;       ///< points of a texel that two triangles may both own: then it overlaps
constexpr double kDegenerateUv = 1e-10;  ///< texels^2: a triangle with less is put whole into the texel of its middle
constexpr double kWholeTexel = 1 - 1e-9;

/// A convex polygon; a triangle clipped by a texel's four sides has at most seven corners.
struct Polygon {
  std::array<dvec2, 8> p;
  int count = 0;

  /// Sutherland and Hodgman: keeps what has sign * p[axis] <= sign * limit.
  Polygon clipped(int axis, double limit, double sign) const {
    Polygon out;
    for (int i = 0; i < count; ++i) {
      const dvec2 a = p[static_cast<size_t>(i)], b = p[static_cast<size_t>(i + 1 == count ? 0 : i + 1)];
      const double da = sign * (limit - a[axis]), db = sign * (limit - b[axis]);
      if (da >= 0) out.p[static_cast<size_t>(out.count++)] = a;
      if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
        dvec2 q = a + (b - a) * (da / (da - db));
        q[axis] = limit;
        out.p[static_cast<size_t>(out.count++)] = q;
      }
    }
    return out;
  }
  Polygon between(int axis, double low, double high) const { return clipped(axis, high, 1).clipped(axis, low, -1); }

  double area(dvec2* centroid) const {
    double doubled = 0;
    dvec2 sum(0.0);
    for (int i = 1; i + 1 < count; ++i) {
      const dvec2 a = p[static_cast<size_t>(i)] - p[0], b = p[static_cast<size_t>(i + 1)] - p[0];
      const double cross = a.x * b.y - a.y * b.x;
      doubled += cross;
      sum += cross * (a + b);
    }
    *centroid = count > 0 ? p[0] : dvec2(0.0);
    if (doubled != 0) *centroid += sum / (3 * doubled);
    return 0.5 * std::abs(doubled);
  }
};

struct UvTriangle {
  dvec2 a, b, c;        ///< texels
  double doubledArea;   ///< signed, texels^2
  double worldArea;

  dvec3 weights(dvec2 p) const {
    const double wb = ((p.x - a.x) * (c.y - a.y) - (p.y - a.y) * (c.x - a.x)) / doubledArea;
    const double wc = ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / doubledArea;
    return {1 - wb - wc, wb, wc};
  }
};

struct Texel {
  double area = 0, largest = 0;
  dvec2 moment{0.0}, largestCentroid{0.0};  ///< area times centroid; centroid of the largest piece
  dvec3 albedo{0.0}, emission{0.0};
  uint64_t claimed = 0;
  uint32_t triangle = kNone, largestTriangle = kNone;  ///< that holds the centroid; with the largest piece
  uint32_t pieces = 0;
  bool overlaps = false;
};

class Band {
 public:
  Band(const Scene& scene, const SurfaceColour& colour, const std::vector<vec2>& uvs, int resolution, int firstRow)
      : scene_(scene), colour_(colour), uvs_(uvs), resolution_(resolution), firstRow_(firstRow),
        rows_(std::min(kBandRows, resolution - firstRow)), texels_(static_cast<size_t>(rows_) * resolution) {}

  void run(const std::vector<uint32_t>& triangles, const Progress& progress) {
    for (uint32_t t : triangles) add(t), progress.check();
    for (uint32_t t : triangles) claimCentroids(t);
  }

  void collect(std::vector<Lumel>& lumels, std::vector<uint8_t>& overlaps) const {
    for (size_t i = 0; i < texels_.size(); ++i) {
      const Texel& texel = texels_[i];
      if (!(texel.area > 0)) continue;
      lumels.push_back(lumelOf(texel, static_cast<uint32_t>(i + static_cast<size_t>(firstRow_) * resolution_)));
      overlaps.push_back(texel.overlaps);
    }
  }

 private:
  Texel& at(int x, int y) { return texels_[static_cast<size_t>(y - firstRow_) * resolution_ + x]; }

  UvTriangle triangle(uint32_t t) const {
    UvTriangle u;
    u.a = dvec2(uvs_[3 * t]) * static_cast<double>(resolution_);
    u.b = dvec2(uvs_[3 * t + 1]) * static_cast<double>(resolution_);
    u.c = dvec2(uvs_[3 * t + 2]) * static_cast<double>(resolution_);
    u.doubledArea = (u.b.x - u.a.x) * (u.c.y - u.a.y) - (u.b.y - u.a.y) * (u.c.x - u.a.x);
    u.worldArea = worldArea(t);
    return u;
  }

  double worldArea(uint32_t t) const {
    const uvec3 i = scene_.indices[t];
    const dvec3 a(scene_.positions[i.x]);
    return 0.5 * glm::length(glm::cross(dvec3(scene_.positions[i.y]) - a, dvec3(scene_.positions[i.z]) - a));
  }

  void add(uint32_t t) {
    const UvTriangle u = triangle(t);
    if (!(u.worldArea > 0)) return;
    if (std::abs(u.doubledArea) < 2 * kDegenerateUv) {
      const dvec2 middle = (u.a + u.b + u.c) / 3.0;
      const int x = static_cast<int>(std::floor(middle.x)), y = static_cast<int>(std::floor(middle.y));
      if (x >= 0 && x < resolution_ && y >= firstRow_ && y < firstRow_ + rows_)
        addPiece(at(x, y), t, u.worldArea, middle, colour_.at(t, dvec3(1.0 / 3)), 0);
      return;
    }
    const OwnershipTest owner(u.a, u.b, u.c);
    const double worldPerTexel = u.worldArea / (0.5 * std::abs(u.doubledArea));
    const Polygon whole{{u.a, u.b, u.c}, 3};
    const double lowV = std::min({u.a.y, u.b.y, u.c.y}), highV = std::max({u.a.y, u.b.y, u.c.y});
    const int y0 = std::max(firstRow_, static_cast<int>(std::floor(lowV)));
    const int y1 = std::min(firstRow_ + rows_ - 1, static_cast<int>(std::floor(highV)));
    for (int y = y0; y <= y1; ++y) {
      const Polygon row = whole.between(1, y, y + 1);
      if (row.count < 3) continue;
      double lowU = 1e300, highU = -1e300;
      for (int i = 0; i < row.count; ++i) {
        lowU = std::min(lowU, row.p[static_cast<size_t>(i)].x);
        highU = std::max(highU, row.p[static_cast<size_t>(i)].x);
      }
      const int x0 = std::max(0, static_cast<int>(std::floor(lowU))), x1 = std::min(resolution_ - 1, static_cast<int>(std::floor(highU)));
      for (int x = x0; x <= x1; ++x) {
        dvec2 centroid;
        const double area = row.between(0, x, x + 1).area(&centroid);
        if (!(area > 0)) continue;
        const uint64_t claimed = claims(owner, area, x, y);
        addPiece(at(x, y), t, area * worldPerTexel, centroid, meanColour(t, u, claimed, centroid, x, y), claimed);
      }
    }
  }

  static dvec2 samplePoint(int sample, int x, int y) {
    return {x + (sample % kSamplesPerSide + 0.5) / kSamplesPerSide, y + (sample / kSamplesPerSide + 0.5) / kSamplesPerSide};
  }

  static uint64_t claims(const OwnershipTest& owner, double area, int x, int y) {
    static_assert(kSamplesPerSide * kSamplesPerSide == 64);
    if (area >= kWholeTexel) return ~uint64_t{0};
    uint64_t mask = 0;
    for (int s = 0; s < 64; ++s) mask |= static_cast<uint64_t>(owner.owns(samplePoint(s, x, y))) << s;
    return mask;
  }

  /// Over the points that the triangle owns (every fourth of a texel's 64), or at the piece's centroid where it owns none.
  SurfaceColour::Sample meanColour(uint32_t t, const UvTriangle& u, uint64_t claimed, dvec2 centroid, int x, int y) const {
    if (!colour_.varies(t)) return colour_.at(t, dvec3(1.0 / 3));
    constexpr uint64_t kEveryFourth = 0x0055005500550055ull;
    uint64_t points = claimed & kEveryFourth ? claimed & kEveryFourth : claimed;
    if (points == 0) return colour_.at(t, u.weights(centroid));
    SurfaceColour::Sample opaque, all;
    int opaqueCount = 0, count = 0;
    for (; points != 0; points &= points - 1, ++count) {
      const SurfaceColour::Sample s = colour_.at(t, u.weights(samplePoint(std::countr_zero(points), x, y)));
      all.albedo += s.albedo;
      if (s.opaque) opaque.albedo += s.albedo, ++opaqueCount;
      all.emission = s.emission;
    }
    all.albedo /= count;
    if (opaqueCount > 0) all.albedo = opaque.albedo / static_cast<double>(opaqueCount);
    return all;
  }

  static void addPiece(Texel& texel, uint32_t t, double area, dvec2 centroid, const SurfaceColour::Sample& colour, uint64_t claimed) {
    texel.area += area;
    texel.moment += area * centroid;
    texel.albedo += area * colour.albedo;
    texel.emission += area * colour.emission;
    texel.overlaps |= (texel.claimed & claimed) != 0;
    texel.claimed |= claimed;
    if (area > texel.largest) texel.largest = area, texel.largestTriangle = t, texel.largestCentroid = centroid;
    texel.triangle = ++texel.pieces == 1 ? t : kNone;  // the centroid of a single convex piece lies in it
  }

  /// Where several triangles share a texel: the first that holds the centroid of the whole covered part.
  void claimCentroids(uint32_t t) {
    const UvTriangle u = triangle(t);
    if (std::abs(u.doubledArea) < 2 * kDegenerateUv) return;
    const double lowU = std::min({u.a.x, u.b.x, u.c.x}), highU = std::max({u.a.x, u.b.x, u.c.x});
    const double lowV = std::min({u.a.y, u.b.y, u.c.y}), highV = std::max({u.a.y, u.b.y, u.c.y});
    const int x0 = std::max(0, static_cast<int>(std::floor(lowU))), x1 = std::min(resolution_ - 1, static_cast<int>(std::floor(highU)));
    const int y0 = std::max(firstRow_, static_cast<int>(std::floor(lowV)));
    const int y1 = std::min(firstRow_ + rows_ - 1, static_cast<int>(std::floor(highV)));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        Texel& texel = at(x, y);
        if (texel.triangle != kNone || texel.pieces == 0) continue;
        const dvec3 w = u.weights(texel.moment / texel.area);
        if (w.x >= 0 && w.y >= 0 && w.z >= 0) texel.triangle = t;
      }
    }
  }

  Lumel lumelOf(const Texel& texel, uint32_t index) const {
    const bool held = texel.triangle != kNone;
    const uint32_t t = held ? texel.triangle : texel.largestTriangle;
    const UvTriangle u = triangle(t);
    dvec3 w(1.0 / 3);
    if (std::abs(u.doubledArea) >= 2 * kDegenerateUv) {
      w = glm::max(u.weights(held ? texel.moment / texel.area : texel.largestCentroid), dvec3(0.0));
      w /= w.x + w.y + w.z;
    }
    const uvec3 i = scene_.indices[t];
    const dvec3 a(scene_.positions[i.x]), b(scene_.positions[i.y]), c(scene_.positions[i.z]);
    Lumel lumel;
    lumel.position = vec3(a * w.x + b * w.y + c * w.z);
    lumel.normal = vec3(glm::normalize(glm::cross(b - a, c - a)));
    lumel.area = static_cast<float>(texel.area);
    lumel.texel = index;
    lumel.triangle = t;
    lumel.albedo = vec3(texel.albedo / texel.area);
    lumel.emission = vec3(texel.emission / texel.area);
    return lumel;
  }

  const Scene& scene_;
  const SurfaceColour& colour_;
  const std::vector<vec2>& uvs_;
  int resolution_, firstRow_, rows_;
  std::vector<Texel> texels_;
};

/// Triangles by band of rows, in their own order.
std::vector<std::vector<uint32_t>> sortIntoBands(const Scene& scene, const std::vector<vec2>& uvs, const std::vector<uint8_t>& unplaced, int resolution) {
  std::vector<std::vector<uint32_t>> bands(static_cast<size_t>((resolution + kBandRows - 1) / kBandRows));
  const auto bandOf = [&](float v) {
    const double row = std::floor(static_cast<double>(v) * resolution);
    return std::clamp<int64_t>(static_cast<int64_t>(std::clamp(row, -1e9, 1e9)) / kBandRows, 0, static_cast<int64_t>(bands.size()) - 1);
  };
  for (uint32_t t = 0; t < scene.triangles(); ++t) {
    if (!unplaced.empty() && unplaced[t]) continue;
    const float a = uvs[3 * t].y, b = uvs[3 * t + 1].y, c = uvs[3 * t + 2].y;
    for (int64_t band = bandOf(std::min({a, b, c})); band <= bandOf(std::max({a, b, c})); ++band) bands[static_cast<size_t>(band)].push_back(t);
  }
  return bands;
}

void measureDensity(const Scene& scene, const std::vector<vec2>& uvs, const std::vector<uint8_t>& unplaced, int resolution, Coverage& coverage) {
  double sum = 0, squares = 0, weight = 0;
  for (uint32_t t = 0; t < scene.triangles(); ++t) {
    const uvec3 i = scene.indices[t];
    const dvec3 p(scene.positions[i.x]);
    const double world = 0.5 * glm::length(glm::cross(dvec3(scene.positions[i.y]) - p, dvec3(scene.positions[i.z]) - p));
    coverage.area += world;
    if (!(world > 0) || (!unplaced.empty() && unplaced[t])) continue;
    const dvec2 a(uvs[3 * t]), b(uvs[3 * t + 1]), c(uvs[3 * t + 2]);
    const double flat = 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    const double density = std::sqrt(flat / world) * resolution;
    if (flat * resolution * resolution < kDegenerateUv) coverage.flatArea += world;
    sum += world * density, squares += world * density * density, weight += world;
  }
  if (!(weight > 0)) return;
  coverage.densityMean = sum / weight;
  const double variance = std::max(0.0, squares / weight - coverage.densityMean * coverage.densityMean);
  coverage.densitySpread = coverage.densityMean > 0 ? std::sqrt(variance) / coverage.densityMean : 0;
}

}  // namespace

Coverage coverTexels(const Scene& scene, const std::vector<vec2>& cornerUvs, const std::vector<uint8_t>& unplaced, int resolution, TaskPool& pool,
                     Progress& progress) {
  const std::vector<std::vector<uint32_t>> bands = sortIntoBands(scene, cornerUvs, unplaced, resolution);
  const SurfaceColour colour(scene);
  std::vector<std::vector<Lumel>> lumels(bands.size());
  std::vector<std::vector<uint8_t>> overlaps(bands.size());
  pool.parallelFor(bands.size(), 1, [&](size_t begin, size_t end, unsigned) {
    for (size_t b = begin; b < end; ++b) {
      Band band(scene, colour, cornerUvs, resolution, static_cast<int>(b) * kBandRows);
      band.run(bands[b], progress);
      band.collect(lumels[b], overlaps[b]);
      progress.advance();
    }
  });
  Coverage coverage;
  for (size_t b = 0; b < bands.size(); ++b) {
    coverage.lumels.insert(coverage.lumels.end(), lumels[b].begin(), lumels[b].end());
    coverage.overlaps.insert(coverage.overlaps.end(), overlaps[b].begin(), overlaps[b].end());
  }
  double covered = 0;
  for (const Lumel& l : coverage.lumels) covered += static_cast<double>(l.area);
  for (uint8_t o : coverage.overlaps) coverage.overlapping += o;
  measureDensity(scene, cornerUvs, unplaced, resolution, coverage);
  coverage.uncoveredArea = std::max(0.0, coverage.area - covered);
  return coverage;
}

}  // namespace hl
