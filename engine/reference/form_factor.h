#pragma once
// Form factors without rays, by Lambert's sum over a polygon's edges: the oracle that the ray-traced ones are tested against. In double it holds 1e-12
// at ordinary distances; in float the sum over atan2(|a x b|, a.b) still keeps 1e-7 at 1000 times the polygon's size.
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace hl {

/// From a point with unit normal `n` to a planar polygon (any number of vertices, either winding): the share of its hemisphere's cosine
/// weight, in [0, 1]. The part below the horizon is cut off. Nothing occludes.
template <class T>
T pointToPolygon(const glm::vec<3, T>& from, const glm::vec<3, T>& n, std::span<const glm::vec<3, T>> polygon) {
  using Vec = glm::vec<3, T>;
  std::vector<Vec> above;
  above.reserve(polygon.size() + 1);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec a = polygon[i] - from, b = polygon[(i + 1) % polygon.size()] - from;
    const T ha = glm::dot(a, n), hb = glm::dot(b, n);
    if (ha >= 0) above.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) above.push_back(a + (b - a) * (ha / (ha - hb)));
  }
  T sum = 0;
  for (size_t i = 0; i < above.size(); ++i) {
    const Vec &a = above[i], &b = above[(i + 1) % above.size()];
    const Vec m = glm::cross(a, b - a);
    const T s = glm::length(m);
    if (s > 0) sum += glm::dot(n, m) / s * std::atan2(s, glm::dot(a, b));
  }
  return std::abs(sum) / (2 * std::numbers::pi_v<T>);
}

/// Mean of `f` over the parallelogram corner + s e1 + t e2, s and t in [0, 1]: Gauss-Legendre of 8 x 8 points in each of cells x cells cells that shrink
/// towards the edge t = 0 by `grading` (1: equal), where an integrand with a common edge changes fastest.
double meanOverParallelogram(const glm::dvec3& corner, const glm::dvec3& e1, const glm::dvec3& e2, int cells, double grading,
                             const std::function<double(const glm::dvec3&)>& f);

}  // namespace hl
