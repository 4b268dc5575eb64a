// Distributions of the shared sampling functions, against densities and integrals in double.
#include "shaders/shared/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace hl {
namespace {

using glm::dvec3;
using shared::Random;

constexpr double kPiD = 3.14159265358979323846;

/// Of counts against expectations; for enough degrees of freedom chi^2 is nearly normal. Returns its distance from the mean in standard deviations.
double chiSquareSigmas(const std::vector<double>& counts, const std::vector<double>& expected) {
  double chi = 0;
  for (size_t i = 0; i < counts.size(); ++i) chi += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  const double freedom = static_cast<double>(counts.size()) - 1;
  return (chi - freedom) / std::sqrt(2 * freedom);
}

vec2 uniform2(Random& r) {
  const float x = shared::randomFloat(r);
  return vec2(x, shared::randomFloat(r));
}

TEST(Sampling, BasisIsOrthonormalForEveryDirection) {
  Random r = shared::randomInit(1, 2, 3);
  std::vector<vec3> normals = {vec3(0, 0, 1),  vec3(0, 0, -1), vec3(1, 0, 0),
                               vec3(0, -1, 0), glm::normalize(vec3(1e-6f, -1e-6f, -1)), glm::normalize(vec3(1e-3f, 0, -1))};
  for (int i = 0; i < 2000; ++i) normals.push_back(shared::sampleUniformSphere(uniform2(r)));
  for (const vec3& n : normals) {
    vec3 t, b;
    shared::orthonormalBasis(n, t, b);
    EXPECT_NEAR(glm::dot(t, t), 1, 2e-6);
    EXPECT_NEAR(glm::dot(b, b), 1, 2e-6);
    EXPECT_NEAR(glm::dot(t, n), 0, 1e-6);
    EXPECT_NEAR(glm::dot(b, n), 0, 1e-6);
    EXPECT_NEAR(glm::dot(glm::cross(t, b), n), 1, 2e-6) << "left-handed";
  }
}

/// Bins of equal probability: the density's cumulative in z, and the azimuth. Only 1 in 3e7 good generators would be over 5 standard deviations.
void expectDistribution(const std::function<vec3(vec2)>& sample, const std::function<double(double)>& cumulativeOfZ,
                        const char* name) {
  constexpr int kBins = 16, kSamples = 1 << 18;
  std::vector<double> counts(kBins * kBins), expected(kBins * kBins, double{kSamples} / (kBins * kBins));
  Random r = shared::randomInit(7, 11, 13);
  for (int i = 0; i < kSamples; ++i) {
    const vec3 d = sample(uniform2(r));
    ASSERT_NEAR(glm::length(d), 1, 1e-5) << name;
    const double c = std::clamp(cumulativeOfZ(static_cast<double>(d.z)), 0.0, 1 - 1e-9);
    const double a = std::atan2(static_cast<double>(d.y), static_cast<double>(d.x)) / (2 * kPiD) + 0.5;
    const int row = static_cast<int>(c * kBins), column = std::min(kBins - 1, static_cast<int>(a * kBins));
    ++counts[static_cast<size_t>(row * kBins + column)];
  }
  EXPECT_LT(std::abs(chiSquareSigmas(counts, expected)), 5) << name;
}

TEST(Sampling, DirectionsHaveTheirDensity) {
  expectDistribution([](vec2 u) { return shared::sampleCosineHemisphere(u); }, [](double z) { return z * z; }, "cosine");
  expectDistribution([](vec2 u) { return shared::sampleUniformHemisphere(u); }, [](double z) { return z; }, "hemisphere");
  expectDistribution([](vec2 u) { return shared::sampleUniformSphere(u); }, [](double z) { return 0.5 * (z + 1); }, "sphere");
}

// The clamped cosine's own moments: E[z] = 2/3, E[z^2] = 1/2, E[x^2] = 1/4; with stratified points far within what random ones would give.
TEST(Sampling, CosineMoments) {
  constexpr uint32_t kCount = 1u << 16;
  dvec3 first(0), second(0);
  for (uint32_t i = 0; i < kCount; ++i) {
    const dvec3 d(shared::sampleCosineHemisphere(shared::sobolPoint(i, uvec2(0x9e3779b9u, 0x85ebca6bu))));
    first += d / double{kCount}, second += d * d / double{kCount};
  }
  EXPECT_NEAR(first.x, 0, 1e-5);
  EXPECT_NEAR(first.y, 0, 1e-5);
  EXPECT_NEAR(first.z, 2.0 / 3, 1e-5);
  EXPECT_NEAR(second.x, 0.25, 1e-5);
  EXPECT_NEAR(second.y, 0.25, 1e-5);
  EXPECT_NEAR(second.z, 0.5, 1e-5);
}

struct TriangleCase {
  std::string name;
  vec3 from, p0, p1, p2;
};

std::vector<TriangleCase> triangleCases() {
  const vec3 o(0.0f);
  return {
      {"ordinary", o, vec3(-1, -0.5f, 2), vec3(1, -0.5f, 2), vec3(0.2f, 1, 1.5f)},
      {"near, over its inside", o, vec3(-1, -1, 0.02f), vec3(1, -1, 0.02f), vec3(0, 1.5f, 0.02f)},
      {"very near", o, vec3(-1, -1, 1e-3f), vec3(1, -1, 1e-3f), vec3(0, 1.5f, 1e-3f)},
      {"very near its middle", o, vec3(-1, -1, 6e-4f), vec3(1, -1, 6e-4f), vec3(0, 1.2f, 6e-4f)},
      {"near an edge", o, vec3(-1, -1e-3f, 1e-3f), vec3(1, -1e-3f, 1e-3f), vec3(0, 1.5f, 1e-3f)},
      {"near a corner", o, vec3(-1e-3f, -1e-3f, 1e-3f), vec3(1, -1e-3f, 1e-3f), vec3(0, 1.5f, 1e-3f)},
      {"octant", o, vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)},
      {"more than a quarter of the sphere", o, vec3(-3, -2, 0.5f), vec3(3, -2, 0.5f), vec3(0, 4, 0.5f)},
      {"sliver", o, vec3(-1, 0, 1), vec3(1, 1e-4f, 1), vec3(0.9f, 2e-4f, 1)},
      {"edge-on", o, vec3(1, -1, 1e-4f), vec3(1, 1, 1e-4f), vec3(3, 0, 1e-4f)},
      {"small", o, vec3(0, 0, 50), vec3(1, 0, 50), vec3(0, 1, 50)},
      {"tiny", o, vec3(0, 0, 1000), vec3(1e-1f, 0, 1000), vec3(0, 1e-1f, 1000)},
      {"at the limit of area sampling", o, vec3(0, 0, 49.9f), vec3(1, 0, 49.9f), vec3(0, 0.1f, 49.9f)},
      {"away from the origin", vec3(100, 20, -30), vec3(100, 21, -30), vec3(101, 21, -30), vec3(100, 21.5f, -29)},
  };
}

double solidAngleInDouble(const dvec3& a, const dvec3& b, const dvec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double triple = std::abs(glm::dot(a, glm::cross(b - a, c - a)));
  return 2 * std::atan2(triple, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// The integral of the direction over the triangle's solid angle, exact: half the sum over edges of angle times unit normal.
dvec3 meanDirectionInDouble(const std::array<dvec3, 3>& v) {
  dvec3 sum(0);
  for (size_t i = 0; i < 3; ++i) {
    const dvec3 &a = v[i], &b = v[(i + 1) % 3], m = glm::cross(a, b - a);
    sum += glm::normalize(m) * (0.5 * std::atan2(glm::length(m), glm::dot(a, b)));
  }
  return glm::dot(sum, v[0] + v[1] + v[2]) < 0 ? -sum : sum;
}

TEST(Sampling, SolidAngleKeepsItsFigures) {
  for (const TriangleCase& c : triangleCases()) {
    const dvec3 from(c.from);
    const double truth = solidAngleInDouble(dvec3(c.p0) - from, dvec3(c.p1) - from, dvec3(c.p2) - from);
    EXPECT_NEAR(shared::triangleSolidAngle(c.from, c.p0, c.p1, c.p2), truth, 2e-5 * truth) << c.name;
  }
  EXPECT_EQ(shared::triangleSolidAngle(vec3(0), vec3(-1, -1, 0), vec3(1, -1, 0), vec3(0, 1, 0)), 0) << "in its plane";
}

TEST(Sampling, TriangleLightIsUniformInSolidAngle) {
  constexpr uint32_t kCount = 1u << 15;
  for (const TriangleCase& c : triangleCases()) {
    const dvec3 from(c.from);
    const std::array<dvec3, 3> v = {dvec3(c.p0) - from, dvec3(c.p1) - from, dvec3(c.p2) - from};
    const double solidAngle = solidAngleInDouble(v[0], v[1], v[2]);
    // Four parts by the edges' middles: what falls into each, and the integral of the direction over all.
    const dvec3 m01 = 0.5 * (v[0] + v[1]), m12 = 0.5 * (v[1] + v[2]), m20 = 0.5 * (v[2] + v[0]);
    const double parts[4] = {solidAngleInDouble(v[0], m01, m20), solidAngleInDouble(m01, v[1], m12),
                             solidAngleInDouble(m20, m12, v[2]), solidAngleInDouble(m01, m12, m20)};
    double found[4] = {0, 0, 0, 0}, weight = 0;
    dvec3 direction(0);
    const dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    for (uint32_t i = 0; i < kCount; ++i) {
      const shared::TriangleSample s =
          shared::sampleTriangleLight(c.from, c.p0, c.p1, c.p2, shared::sobolPoint(i, uvec2(0x2545f491u, 0x68e31da4u)));
      ASSERT_GT(s.pdf, 0) << c.name;
      const float again = shared::triangleLightPdf(c.from, c.p0, c.p1, c.p2, s.direction, s.distance);
      ASSERT_NEAR(again, s.pdf, 1e-3f * s.pdf) << c.name;
      const double w = 1 / static_cast<double>(s.pdf);
      const dvec3 d(s.direction);
      weight += w / kCount, direction += d * (w / kCount);
      // Barycentrics of where the direction meets the plane.
      const dvec3 at = d * (glm::dot(v[0], normal) / glm::dot(d, normal)) - v[0];
      const double n2 = glm::dot(normal, normal);
      const double u1 = glm::dot(glm::cross(at, v[2] - v[0]), normal) / n2;
      const double u2 = glm::dot(glm::cross(v[1] - v[0], at), normal) / n2;
      const double slack = 1e-3;
      ASSERT_TRUE(u1 > -slack && u2 > -slack && u1 + u2 < 1 + slack) << c.name << " " << u1 << " " << u2;
      found[u1 + u2 < 0.5 ? 0 : (u1 > 0.5 ? 1 : (u2 > 0.5 ? 2 : 3))] += w / kCount;
    }
    EXPECT_NEAR(weight, solidAngle, 2e-3 * solidAngle) << c.name;
    for (int p = 0; p < 4; ++p) EXPECT_NEAR(found[p], parts[p], 4e-3 * solidAngle) << c.name << ", part " << p;
    const dvec3 truth = meanDirectionInDouble(v);
    EXPECT_LT(glm::length(direction - truth), 2e-3 * glm::length(truth)) << c.name;
  }
}

TEST(Sampling, TriangleLightIsUniformInSolidAngleByChiSquare) {
  const vec3 a(1, 0, 0.2f), b(-0.3f, 1, 0.4f), c(-0.2f, -0.6f, 0.5f);  // large: where uniform in area would be far off
  constexpr int kCuts = 8, kSamples = 1 << 17;
  const auto at = [&](int i, int j) {
    return dvec3(a) + (dvec3(b) - dvec3(a)) * (double(i) / kCuts) + (dvec3(c) - dvec3(a)) * (double(j) / kCuts);
  };
  std::vector<double> expected, counts(kCuts * kCuts);
  const double all = solidAngleInDouble(dvec3(a), dvec3(b), dvec3(c));
  // Cell (i, j) has a triangle that points up, and one that points down unless it lies on the far edge.
  std::vector<std::array<int, 3>> cells;
  for (int i = 0; i < kCuts; ++i)
    for (int j = 0; i + j < kCuts; ++j)
      for (int down = 0; down < (i + j + 1 < kCuts ? 2 : 1); ++down) {
        cells.push_back({i, j, down});
        expected.push_back(kSamples / all *
                           (down ? solidAngleInDouble(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))
                                 : solidAngleInDouble(at(i, j), at(i + 1, j), at(i, j + 1))));
      }
  ASSERT_EQ(expected.size(), counts.size());
  Random r = shared::randomInit(5, 6, 7);
  const dvec3 e1 = dvec3(b) - dvec3(a), e2 = dvec3(c) - dvec3(a), n = glm::cross(e1, e2);
  for (int s = 0; s < kSamples; ++s) {
    const dvec3 d(shared::sampleTriangleLight(vec3(0), a, b, c, uniform2(r)).direction);
    const dvec3 p = d * (glm::dot(dvec3(a), n) / glm::dot(d, n)) - dvec3(a);
    const double x = std::clamp(glm::dot(glm::cross(p, e2), n) / glm::dot(n, n), 0.0, 1.0) * kCuts;
    const double y = std::clamp(glm::dot(glm::cross(e1, p), n) / glm::dot(n, n), 0.0, 1.0) * kCuts;
    const int i = std::min(static_cast<int>(x), kCuts - 1), j = std::min(static_cast<int>(y), kCuts - 1 - i);
    const std::array<int, 3> key = {i, j, (x - i) + (y - j) > 1 ? 1 : 0};
    const auto found = std::find(cells.begin(), cells.end(), key);
    ASSERT_TRUE(found != cells.end());
    ++counts[static_cast<size_t>(found - cells.begin())];
  }
  EXPECT_LT(std::abs(chiSquareSigmas(counts, expected)), 5);
}

/// Every elementary interval of a (0, 2)-net holds one point.
void expectNet(const std::function<vec2(uint32_t)>& point, const char* name) {
  constexpr int kLog = 8;
  for (int a = 0; a <= kLog; ++a) {
    std::set<std::pair<int, int>> cells;
    for (uint32_t i = 0; i < (1u << kLog); ++i) {
      const vec2 p = point(i);
      ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
      cells.insert({static_cast<int>(p.x * float(1 << a)), static_cast<int>(p.y * float(1 << (kLog - a)))});
    }
    EXPECT_EQ(cells.size(), size_t{1} << kLog) << name << ", 2^" << a << " columns";
  }
}

TEST(Sampling, SobolPointsAreNets) {
  expectNet([](uint32_t i) { return shared::sobolPoint(i, uvec2(0u)); }, "plain");
  expectNet([](uint32_t i) { return shared::sobolPoint(i + 768, uvec2(0x12345678u, 0xdeadbeefu)); }, "scrambled, later block");
  for (uint32_t seed = 0; seed < 20; ++seed)
    expectNet([seed](uint32_t i) { return shared::shuffledSobolPoint(i, seed * 7919u); }, "shuffled");
}

// Over seeds, each shuffled point is uniform, and points of different seeds are unrelated: what unbiased means and independent halves rest on.
TEST(Sampling, ShuffledPointsAreUniformAndIndependentOverSeeds) {
  constexpr uint32_t kSeeds = 1u << 16;
  for (const uint32_t index : {0u, 1u, 5u, 1000u}) {
    std::vector<double> counts(256), expected(256, kSeeds / 256.0);
    double cross = 0;
    for (uint32_t s = 0; s < kSeeds; ++s) {
      const vec2 p = shared::shuffledSobolPoint(index, shared::pcgHash(s));
      const vec2 q = shared::shuffledSobolPoint(index, shared::pcgHash(s ^ 0x80000000u));
      ++counts[static_cast<size_t>(p.x * 16) * 16 + static_cast<size_t>(p.y * 16)];
      cross += (static_cast<double>(p.x) - 0.5) * (static_cast<double>(q.x) - 0.5) * 12 / kSeeds;
    }
    EXPECT_LT(std::abs(chiSquareSigmas(counts, expected)), 5) << "index " << index;
    EXPECT_LT(std::abs(cross), 5 / std::sqrt(double{kSeeds})) << "index " << index;
  }
}

TEST(Sampling, R2PointsAreEvenAndExactAtLargeIndices) {
  // Largest distance of a mean from its integral over a block far out in the sequence: a float accumulator would have lost its fraction.
  for (const uint32_t start : {0u, 1u << 20, 4000000000u}) {
    dvec3 mean(0);
    constexpr uint32_t kCount = 4096;
    for (uint32_t i = 0; i < kCount; ++i) {
      const vec2 p = shared::r2Point(start + i, uvec2(0x51ed270bu, 0xc2b2ae35u));
      const double x = static_cast<double>(p.x), y = static_cast<double>(p.y);
      mean += dvec3(x, y, x * y) / double{kCount};
    }
    EXPECT_NEAR(mean.x, 0.5, 1e-3);
    EXPECT_NEAR(mean.y, 0.5, 1e-3);
    EXPECT_NEAR(mean.z, 0.25, 2e-3);
  }
}

TEST(Sampling, TrianglePointsAreUniform) {
  constexpr uint32_t kCount = 1u << 14;
  dvec3 mean(0);
  for (uint32_t i = 0; i < kCount; ++i) {
    const vec2 w = shared::sampleTriangle(shared::sobolPoint(i, uvec2(77u, 99u)));
    ASSERT_TRUE(w.x >= 0 && w.y >= 0 && w.x + w.y <= 1);
    const double x = static_cast<double>(w.x), y = static_cast<double>(w.y);
    mean += dvec3(x, y, x * y) / double{kCount};
  }
  EXPECT_NEAR(mean.x, 1.0 / 3, 1e-4);
  EXPECT_NEAR(mean.y, 1.0 / 3, 1e-4);
  EXPECT_NEAR(mean.z, 1.0 / 12, 1e-4);
}

TEST(Sampling, WeightsSumToOne) {
  for (const float a : {1e-30f, 0.3f, 7.0f, 1e20f})
    for (const float b : {1e-30f, 0.2f, 9.0f, 1e25f}) {
      EXPECT_NEAR(shared::balanceHeuristic(a, b) + shared::balanceHeuristic(b, a), 1, 1e-6);
      EXPECT_NEAR(shared::powerHeuristic(a, b) + shared::powerHeuristic(b, a), 1, 1e-6);
    }
  EXPECT_EQ(shared::powerHeuristic(0, 1), 0);
  EXPECT_EQ(shared::powerHeuristic(1, 0), 1);
  EXPECT_EQ(shared::balanceHeuristic(0, 0), 0);
}

TEST(Sampling, SpotFalloff) {
  EXPECT_EQ(shared::spotFalloff(1, 0.9f, 0.8f), 1);
  EXPECT_EQ(shared::spotFalloff(0.9f, 0.9f, 0.8f), 1);
  EXPECT_NEAR(shared::spotFalloff(0.85f, 0.9f, 0.8f), 0.5f, 1e-5f);
  EXPECT_EQ(shared::spotFalloff(0.8f, 0.9f, 0.8f), 0);
  EXPECT_EQ(shared::spotFalloff(-1, 0.9f, 0.8f), 0);
  EXPECT_EQ(shared::spotFalloff(0.85f, 0.8f, 0.8f), 1) << "a hard edge";
  EXPECT_EQ(shared::spotFalloff(0.75f, 0.8f, 0.8f), 0) << "a hard edge";
}

}  // namespace
}  // namespace hl
