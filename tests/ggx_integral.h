#pragma once
// The lobe of shaders/shared/ggx.h once more, in double and as its papers write it, and integrals of it: what the shared single-precision one is held against.
#include <cmath>
#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

namespace hl::test {

constexpr double kPiDouble = 3.14159265358979323846;

inline double ggxD(double cosine, double alpha) {
  const double a2 = alpha * alpha, t = cosine * cosine * (a2 - 1) + 1;
  return a2 / (kPiDouble * t * t);
}
inline double ggxLambda(double cosine, double alpha) {
  const double tan2 = 1 / (cosine * cosine) - 1;
  return (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
}
inline double ggxF(double f0, double cosine) { return f0 + (1 - f0) * std::pow(1 - cosine, 5); }
inline double ggxG2(double v, double l, double alpha) { return 1 / (1 + ggxLambda(v, alpha) + ggxLambda(l, alpha)); }

/// Cook and Torrance's quotient; the frame's normal is +z.
inline double ggxLobe(const glm::dvec3& view, const glm::dvec3& light, double f0, double alpha) {
  const glm::dvec3 h = glm::normalize(view + light);
  return ggxF(f0, glm::dot(view, h)) * ggxD(h.z, alpha) * ggxG2(view.z, light.z, alpha) / (4 * view.z * light.z);
}

/// Integral over light directions above the surface of f(light), by the midpoint rule over facets' normals that lie as D does: a narrow lobe is met as well as a wide one.
template <class F>
double overLobe(const glm::dvec3& view, double alpha, int steps, F&& f) {
  double sum = 0;
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < steps; ++k) {
      const double u = (i + 0.5) / steps, phi = 2 * kPiDouble * (k + 0.5) / steps;
      const double tan2 = alpha * alpha * u / (1 - u), z = 1 / std::sqrt(1 + tan2), s = std::sqrt(1 - z * z);
      const glm::dvec3 h(s * std::cos(phi), s * std::sin(phi), z);
      const double c = glm::dot(view, h);
      const glm::dvec3 light = 2 * c * h - view;
      // dw_h = du dphi / (2 pi D z), dw_light = 4 (view . h) dw_h.
      if (c > 0 && light.z > 0) sum += f(light) * 4 * c / (ggxD(z, alpha) * z);
    }
  return sum / (double{1} * steps * steps);
}

/// Share of the light from (or towards) a direction of that cosine that the lobe reflects.
inline double directionalAlbedo(double f0, double cosine, double roughness, int steps = 600) {
  const double alpha = roughness * roughness;
  const glm::dvec3 view(std::sqrt(1 - cosine * cosine), 0, cosine);
  return overLobe(view, alpha, steps, [&](const glm::dvec3& light) { return ggxLobe(view, light, f0, alpha) * light.z; });
}

}  // namespace hl::test
