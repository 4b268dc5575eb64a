// Identities that spherical harmonics obey, to 1e-12 in double precision.
#include "engine/core/spherical_harmonics64.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace hl {
namespace {

using namespace sh64;
using glm::dmat3;
using glm::dvec3;
constexpr double kPi = std::numbers::pi;

/// A rule on the sphere that is exact for polynomials to degree 2 * kNodes - 1: Gauss-Legendre in z, even steps round the axis.
struct Rule {
  std::vector<dvec3> directions;
  std::vector<double> weights;  ///< sum 4 pi
};
constexpr int kNodes = 16;
const Rule& rule() {
  static const Rule r = [] {
    Rule out;
    for (int i = 0; i < kNodes; ++i) {
      double z = std::cos(kPi * (i + 0.75) / (kNodes + 0.5)), slope = 0;
      for (int step = 0; step < 20; ++step) {
        double p0 = 1, p1 = z;
        for (int k = 2; k <= kNodes; ++k) {
          const double p2 = ((2 * k - 1) * z * p1 - (k - 1) * p0) / k;
          p0 = p1, p1 = p2;
        }
        slope = kNodes * (z * p1 - p0) / (z * z - 1);
        z -= p1 / slope;
      }
      const double weight = 2 / ((1 - z * z) * slope * slope), s = std::sqrt(1 - z * z);
      for (int k = 0; k < 2 * kNodes; ++k) {
        const double phi = kPi * (k + 0.5) / kNodes;
        out.directions.emplace_back(s * std::cos(phi), s * std::sin(phi), z);
        out.weights.push_back(weight * kPi / kNodes);
      }
    }
    return out;
  }();
  return r;
}

dvec3 anyDirection(std::mt19937& g) {
  std::normal_distribution<double> n;
  const double x = n(g), y = n(g);
  return glm::normalize(dvec3(x, y, n(g)));
}
dmat3 anyRotation(std::mt19937& g) {
  const dvec3 a = anyDirection(g), b = glm::normalize(glm::cross(a, anyDirection(g)));
  return dmat3(a, b, glm::cross(a, b));
}
ShCoefficients anyFunction(std::mt19937& g) {
  std::normal_distribution<double> n;
  ShCoefficients f;
  for (double& c : f.c) c = n(g);
  return f;
}
double legendre(int l, double x) {
  double p0 = 1, p1 = x;
  if (l == 0) return 1;
  for (int k = 2; k <= l; ++k) {
    const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
    p0 = p1, p1 = p2;
  }
  return p1;
}

TEST(SphericalHarmonics, AreThePolynomialsThatTheFieldWritesDown) {
  std::mt19937 g(1);
  for (int i = 0; i < 100; ++i) {
    const dvec3 d = i == 0 ? dvec3(0, 0, 1) : i == 1 ? dvec3(0, 0, -1) : i == 2 ? dvec3(1, 0, 0) : anyDirection(g);
    const ShCoefficients y = shBasis(kShMaxOrder, d);
    const double a = std::sqrt(3 / (4 * kPi)), b = std::sqrt(15 / (4 * kPi));
    const double expected[] = {std::sqrt(1 / (4 * kPi)), a * d.y, a * d.z, a * d.x, b * d.x * d.y, b * d.y * d.z, std::sqrt(5 / (16 * kPi)) * (3 * d.z * d.z - 1), b * d.x * d.z,
                               b / 2 * (d.x * d.x - d.y * d.y)};
    for (int k = 0; k < 9; ++k) ASSERT_NEAR(y.c[k], expected[k], 1e-13) << k;
    ASSERT_NEAR(y.c[shIndex(3, -3)], std::sqrt(35 / (32 * kPi)) * d.y * (3 * d.x * d.x - d.y * d.y), 1e-13);
    ASSERT_NEAR(y.c[shIndex(4, 0)], 3.0 / 16 * std::sqrt(1 / kPi) * (35 * std::pow(d.z, 4) - 30 * d.z * d.z + 3), 1e-13);
  }
}

TEST(SphericalHarmonics, AreOrthonormal) {
  std::vector<ShCoefficients> y;
  for (const dvec3& d : rule().directions) y.push_back(shBasis(kShMaxOrder, d));
  for (int a = 0; a < kShMaxCoefficients; ++a)
    for (int b = 0; b <= a; ++b) {
      double sum = 0;
      for (size_t i = 0; i < y.size(); ++i) sum += rule().weights[i] * y[i].c[a] * y[i].c[b];
      ASSERT_NEAR(sum, a == b ? 1 : 0, 1e-12) << a << " " << b;
    }
}

TEST(SphericalHarmonics, ObeyTheAdditionTheoremAtEveryOrder) {
  std::mt19937 g(2);
  for (int i = 0; i < 100; ++i) {
    const dvec3 d = anyDirection(g), e = i == 0 ? d : i == 1 ? -d : anyDirection(g);
    const ShCoefficients a = shBasis(kShMaxOrder, d), b = shBasis(kShMaxOrder, e);
    for (int l = 0; l <= kShMaxOrder; ++l) {
      double sum = 0;
      for (int m = -l; m <= l; ++m) sum += a.c[shIndex(l, m)] * b.c[shIndex(l, m)];
      ASSERT_NEAR(sum, (2 * l + 1) / (4 * kPi) * legendre(l, glm::dot(d, e)), 1e-12) << l;
    }
  }
  for (int order = 0; order <= kShMaxOrder; ++order) {
    const dvec3 d = anyDirection(g);
    const ShCoefficients low = shBasis(order, d), all = shBasis(kShMaxOrder, d), f = anyFunction(g);
    double sum = 0;
    for (int k = 0; k < shCount(order); ++k) {
      ASSERT_EQ(low.c[k], all.c[k]) << "coefficients do not depend on the order";
      sum += all.c[k] * f.c[k];
    }
    ASSERT_NEAR(shEvaluate(order, f, d), sum, 1e-12);
  }
}

TEST(SphericalHarmonics, ClampedCosineHasItsCoefficientsAndEnergy) {
  const double expected[] = {kPi, 2 * kPi / 3, kPi / 4, 0, -kPi / 24, 0, kPi / 64, 0, -kPi / 128};
  double energy = 0;
  const double after[] = {0.375, 0.875, 0.9921875};
  for (int l = 0; l <= kShMaxOrder; ++l) {
    EXPECT_NEAR(shClampedCosine(l), expected[l], 1e-14) << l;
    // As a function round +Z its coefficient in band l is A_l sqrt((2l + 1) / (4 pi)); its whole energy is 2 pi / 3.
    energy += std::pow(shClampedCosine(l), 2) * (2 * l + 1) / (4 * kPi) / (2 * kPi / 3);
    if (l < 3) {
      EXPECT_NEAR(energy, after[l], 1e-14) << l;
    }
  }
  EXPECT_LT(energy, 1);
}

/// Irradiance of what has these coefficients.
ShCoefficients irradianceOf(int order, ShCoefficients f) {
  for (int l = 0; l <= order; ++l)
    for (int m = -l; m <= l; ++m) f.c[shIndex(l, m)] *= shClampedCosine(l);
  return f;
}

TEST(SphericalHarmonics, IrradianceOfConstantLightHalfASkyAndTheSun) {
  std::mt19937 g(3);
  const dvec3 up = anyDirection(g);
  // Half the sky, by closed form: its zonal coefficients are sqrt((2l + 1) pi) times the integral of P_l over [0, 1].
  ShCoefficients constant{}, sky{}, sun{};
  constant.c[0] = 3 * std::sqrt(4 * kPi);
  const ShCoefficients y = shBasis(kShMaxOrder, up);
  for (int l = 0; l <= kShMaxOrder; ++l)
    for (int m = -l; m <= l; ++m) {
      const double half = l == 0 ? 1 : (legendre(l - 1, 0) - legendre(l + 1, 0)) / (2 * l + 1);
      sky.c[shIndex(l, m)] = 2 * kPi * half * y.c[shIndex(l, m)];
      sun.c[shIndex(l, m)] = y.c[shIndex(l, m)];
    }
  for (int i = 0; i < 50; ++i) {
    const dvec3 n = anyDirection(g);
    for (int order = 0; order <= kShMaxOrder; ++order) ASSERT_NEAR(shEvaluate(order, irradianceOf(order, constant), n), 3 * kPi, 1e-12);
    for (int order = 1; order <= kShMaxOrder; ++order) ASSERT_NEAR(shEvaluate(order, irradianceOf(order, sky), n), kPi * (1 + glm::dot(n, up)) / 2, 1e-12) << order;
  }
  EXPECT_NEAR(shEvaluate(2, irradianceOf(2, sun), up), 17.0 / 16, 1e-12);
  const dvec3 side = glm::normalize(glm::cross(up, anyDirection(g)));
  double least = 1, at = 0;
  for (double t = 110; t < 130; t += 0.01)
    if (const double e = shEvaluate(2, irradianceOf(2, sun), up * std::cos(t * kPi / 180) + side * std::sin(t * kPi / 180)); e < least) least = e, at = t;
  EXPECT_NEAR(least, -0.03958, 1e-5);
  EXPECT_NEAR(at, 122.2, 0.05);
}

TEST(SphericalHarmonics, ProjectionAndParseval) {
  std::mt19937 g(4);
  const ShCoefficients f = anyFunction(g);
  ShCoefficients back{};
  double energy = 0, sum = 0;
  for (size_t i = 0; i < rule().directions.size(); ++i) {
    const double value = shEvaluate(kShMaxOrder, f, rule().directions[i]);
    const ShCoefficients y = shBasis(kShMaxOrder, rule().directions[i]);
    for (int k = 0; k < kShMaxCoefficients; ++k) back.c[k] += rule().weights[i] * value * y.c[k];
    energy += rule().weights[i] * value * value;
  }
  for (int k = 0; k < kShMaxCoefficients; ++k) {
    ASSERT_NEAR(back.c[k], f.c[k], 1e-12) << k;
    sum += f.c[k] * f.c[k];
  }
  EXPECT_NEAR(energy / sum, 1, 1e-12);
}

TEST(SphericalHarmonics, RotationTurnsTheFunctionAndKeepsEachBandsPower) {
  std::mt19937 g(5);
  for (int i = 0; i < 40; ++i) {
    const ShCoefficients f = anyFunction(g);
    const dmat3 quarter(dvec3(0, 1, 0), dvec3(-1, 0, 0), dvec3(0, 0, 1)), half(dvec3(-1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, -1));
    const dmat3 r = i == 0 ? dmat3(1) : i == 1 ? quarter : i == 2 ? half : anyRotation(g);
    const ShCoefficients turned = shRotate(kShMaxOrder, f, r);
    for (int k = 0; k < 20; ++k) {
      const dvec3 d = anyDirection(g);
      ASSERT_NEAR(shEvaluate(kShMaxOrder, turned, r * d), shEvaluate(kShMaxOrder, f, d), 1e-12 * 20) << i;  // of values of about 3
    }
    for (int l = 0; l <= kShMaxOrder; ++l) {
      double before = 0, after = 0;
      for (int m = -l; m <= l; ++m) before += std::pow(f.c[shIndex(l, m)], 2), after += std::pow(turned.c[shIndex(l, m)], 2);
      ASSERT_NEAR(after / before, 1, 1e-12) << l;
    }
    const ShCoefficients back = shRotate(kShMaxOrder, turned, glm::transpose(r));
    for (int k = 0; k < kShMaxCoefficients; ++k) ASSERT_NEAR(back.c[k], f.c[k], 1e-12 * 10);
  }
}

TEST(SphericalHarmonics, WindowsLeaveBandZeroAndFallOff) {
  for (const int window : {kShWindowNone, kShWindowHann, kShWindowLanczos})
    for (int order = 0; order <= kShMaxOrder; ++order) {
      EXPECT_EQ(shWindow(window, 0, order), 1);
      for (int l = 1; l <= order; ++l) {
        const double w = shWindow(window, l, order);
        if (window == kShWindowNone) {
          EXPECT_EQ(w, 1);
        } else {
          EXPECT_LT(w, shWindow(window, l - 1, order));
          EXPECT_GT(w, 0);
        }
      }
    }
  EXPECT_NEAR(shWindow(kShWindowHann, 2, 3), 0.5, 1e-15);
  EXPECT_NEAR(shWindow(kShWindowLanczos, 2, 3), 2 / kPi, 1e-15);
}

}  // namespace
}  // namespace hl
