#include "engine/techniques/radiosity/directions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "shaders/shared/sampling.h"

namespace hl {
namespace {

using glm::dvec2;

constexpr double kTau = 6.283185307179586;
constexpr double kFar = 3;  ///< half the side of the square that cells start from; it holds the disc with room to spare

using Polygon = std::vector<dvec2>;

double cross(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

/// The Voronoi cell of points[index] among all of them, within the far square.
Polygon voronoiCell(const std::vector<dvec2>& points, size_t index) {
  Polygon cell{{-kFar, -kFar}, {kFar, -kFar}, {kFar, kFar}, {-kFar, kFar}}, next;
  const dvec2 p = points[index];
  double reach2 = 8 * kFar * kFar * 4;  // square of twice the distance to the farthest corner: further points cut nothing off
  for (size_t j = 0; j < points.size(); ++j) {
    const dvec2 d = points[j] - p;
    const double d2 = glm::dot(d, d);
    if (j == index || d2 >= reach2 || d2 == 0) continue;
    const double limit = glm::dot(d, 0.5 * (points[j] + p));
    next.clear();
    for (size_t i = 0; i < cell.size(); ++i) {
      const dvec2 a = cell[i], b = cell[i + 1 == cell.size() ? 0 : i + 1];
      const double da = limit - glm::dot(d, a), db = limit - glm::dot(d, b);
      if (da >= 0) next.push_back(a);
      if ((da > 0 && db < 0) || (da < 0 && db > 0)) next.push_back(a + (b - a) * (da / (da - db)));
    }
    cell.swap(next);
    reach2 = 0;
    for (dvec2 v : cell) reach2 = std::max(reach2, 4 * glm::dot(v - p, v - p));
  }
  return cell;
}

/// Where the segment from a to b meets the unit circle: parameters in [0, 1].
int circleCrossings(dvec2 a, dvec2 b, std::array<double, 2>& t) {
  const dvec2 d = b - a;
  const double qa = glm::dot(d, d), qb = glm::dot(a, d), qc = glm::dot(a, a) - 1, root2 = qb * qb - qa * qc;
  if (qa == 0 || root2 <= 0) return 0;
  const double root = std::sqrt(root2);
  int n = 0;
  for (const double s : {(-qb - root) / qa, (-qb + root) / qa})
    if (s >= 0 && s <= 1) t[static_cast<size_t>(n++)] = s;
  return n;
}

/// Integrals over a region of the disc, with z the height of the hemisphere above it.
struct Moments {
  double area = 0, height = 0;  ///< of 1 and of z
  dvec2 first{0.0};             ///< of the position
};

/// (1 - (1 - x)^(3/2)) / (3 x): what a thin triangle from the centre with its far side at x = r^2 holds of z, as a share of its doubled area.
double heightShare(double x) {
  if (x < 1e-6) return 0.5 - 0.125 * x;
  const double y = std::max(0.0, 1 - x);
  return (1 - y * std::sqrt(y)) / (3 * x);
}

/// The triangle from the centre to a straight piece of outline inside the disc: by Gauss's rule, in steps.
void addTriangle(dvec2 a, dvec2 b, Moments& m) {
  constexpr double kNodes[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr double kWeights[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  constexpr int kSteps = 16;
  const double turn = cross(a, b);
  m.area += 0.5 * turn;
  m.first += turn * (a + b) / 6.0;
  for (int step = 0; step < kSteps; ++step) {
    for (size_t k = 0; k < 4; ++k) {
      const dvec2 q = a + (b - a) * ((step + 0.5 + 0.5 * kNodes[k]) / kSteps);
      m.height += turn * heightShare(glm::dot(q, q)) * kWeights[k] * 0.5 / kSteps;
    }
  }
}

void addSector(dvec2 a, dvec2 b, Moments& m) {
  const double angle = std::atan2(cross(a, b), glm::dot(a, b));
  const dvec2 from = glm::normalize(a), to = glm::normalize(b);
  m.area += 0.5 * angle;
  m.height += angle / 3;
  m.first += dvec2(to.y - from.y, from.x - to.x) / 3.0;
}

/// Of the polygon (anticlockwise) within the unit disc.
Moments momentsInDisc(const Polygon& polygon) {
  Moments m;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const dvec2 a = polygon[i], b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    std::array<double, 2> t{};
    const int n = circleCrossings(a, b, t);
    dvec2 from = a;
    for (int k = 0; k <= n; ++k) {
      const dvec2 to = k == n ? b : a + (b - a) * t[static_cast<size_t>(k)];
      const dvec2 middle = 0.5 * (from + to);
      glm::dot(middle, middle) <= 1 ? addTriangle(from, to, m) : addSector(from, to, m);
      from = to;
    }
  }
  return m;
}

/// The direction that stands for a cell.
DiscDirection meanOfCell(const Polygon& cell, dvec2 generator) {
  const Moments m = momentsInDisc(cell);
  if (!(m.area > 0)) return {generator, 0};
  const double z = std::clamp(m.height / m.area, 0.0, 1.0);
  dvec2 azimuth = m.first / m.area;
  if (glm::length(azimuth) < 1e-9) azimuth = generator;  // the cell is the whole disc
  return {glm::normalize(azimuth) * std::sqrt(1 - z * z), m.area / (0.5 * kTau)};
}

/// Where the next point may go: corners of cells inside the disc and crossings of their sides with its rim.
struct Candidate {
  dvec2 p;
  double distance2;  ///< to the nearest point
};

void addCandidates(const std::vector<dvec2>& points, size_t index, std::vector<Candidate>& candidates) {
  const Polygon cell = voronoiCell(points, index);
  const auto add = [&](dvec2 p) { candidates.push_back({p, glm::dot(p - points[index], p - points[index])}); };
  for (size_t i = 0; i < cell.size(); ++i) {
    const dvec2 a = cell[i], b = cell[i + 1 == cell.size() ? 0 : i + 1];
    if (glm::dot(a, a) <= 1) add(a);
    std::array<double, 2> t{};
    const int n = circleCrossings(a, b, t);
    for (int k = 0; k < n; ++k) add(a + (b - a) * t[static_cast<size_t>(k)]);
  }
}

}  // namespace

uint32_t hilbertIndex(vec2 p) {
  auto x = static_cast<uint32_t>(std::clamp(p.x, 0.0f, 0.99999f) * 65536.0f), y = static_cast<uint32_t>(std::clamp(p.y, 0.0f, 0.99999f) * 65536.0f);
  uint32_t index = 0;
  for (uint32_t side = 32768; side > 0; side /= 2) {
    const uint32_t rx = (x & side) != 0, ry = (y & side) != 0;
    index += side * side * ((3 * rx) ^ ry);
    if (ry == 0) {
      if (rx == 1) x = 65535 - x, y = 65535 - y;
      std::swap(x, y);
    }
  }
  return index;
}

std::vector<vec2> goldenLattice(uint32_t count) {
  constexpr double kGolden = 0.6180339887498949;
  std::vector<vec2> points(count);
  for (uint32_t i = 0; i < count; ++i) {
    const double y = i * kGolden;
    points[i] = vec2(static_cast<float>(i / static_cast<double>(count)), static_cast<float>(y - std::floor(y)));
  }
  std::stable_sort(points.begin(), points.end(), [](vec2 a, vec2 b) { return hilbertIndex(a) < hilbertIndex(b); });
  return points;
}

std::vector<DiscDirection> largestEmptyCircles(uint32_t count, bool unweighted, const Progress* progress) {
  std::vector<dvec2> points;
  for (uint32_t i = 0; i < std::min(count, 4u); ++i) {
    const float u = shared::unitFloat(shared::pcgHash(2 * i)), v = shared::unitFloat(shared::pcgHash(2 * i + 1));
    points.push_back(std::sqrt(static_cast<double>(u)) * dvec2(std::cos(kTau * static_cast<double>(v)), std::sin(kTau * static_cast<double>(v))));
  }
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < points.size(); ++i) addCandidates(points, i, candidates);
  while (points.size() < count) {
    if (progress) progress->check();
    const auto largest = std::max_element(candidates.begin(), candidates.end(),
                                          [](const Candidate& a, const Candidate& b) { return a.distance2 < b.distance2; });
    const dvec2 p = largest->p;
    points.push_back(p);
    // What is now nearer to the new point is no corner any more; the new cell has the corners that replace it.
    std::erase_if(candidates, [&](const Candidate& c) { return glm::dot(c.p - p, c.p - p) < c.distance2 * (1 - 1e-12); });
    addCandidates(points, points.size() - 1, candidates);
  }
  std::vector<DiscDirection> set(count);
  for (uint32_t i = 0; i < count; ++i)
    set[i] = unweighted ? DiscDirection{points[i], 1.0 / count} : meanOfCell(voronoiCell(points, i), points[i]);
  return set;
}

}  // namespace hl
