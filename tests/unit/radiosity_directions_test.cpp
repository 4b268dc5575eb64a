// The sets of directions: cosine distributed, whatever their count.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/techniques/radiosity/directions.h"
#include "shaders/shared/sampling.h"

namespace hl {
namespace {

double height(glm::dvec2 p) { return std::sqrt(std::max(0.0, 1 - p.x * p.x - p.y * p.y)); }

/// Every count up to 128, then some primes, powers and round numbers.
std::vector<uint32_t> counts() {
  std::vector<uint32_t> list;
  for (uint32_t n = 16; n <= 128; ++n) list.push_back(n);
  for (uint32_t n : {150u, 199u, 256u, 300u, 441u, 512u, 700u, 1000u, 1024u, 1500u, 2048u, 3001u, 4096u}) list.push_back(n);
  return list;
}

TEST(Directions, LargestEmptyCirclesIntegrateTheCosine) {
  // L = cos t gives E = integral of cos^2 = 2 pi / 3.
  for (uint32_t n : counts()) {
    double sum = 0, weights = 0;
    for (const DiscDirection& d : largestEmptyCircles(n, false)) {
      ASSERT_GT(d.weight, 0) << n;
      ASSERT_LE(glm::dot(d.p, d.p), 1 + 1e-12) << n;
      weights += d.weight;
      sum += d.weight * height(d.p);
    }
    EXPECT_NEAR(weights, 1, 1e-9) << n;
    EXPECT_NEAR(static_cast<double>(kPi) * sum, 2 * static_cast<double>(kPi) / 3, 0.002 * 2.0944) << n;
  }
}

TEST(Directions, LargestEmptyCirclesIntegrateOtherLights) {
  // Not fitted to: cos^2 (E = pi / 2), cos^4 (pi / 3), and one side of the hemisphere against the other.
  const auto set = largestEmptyCircles(1024, false);
  double second = 0, fourth = 0, side = 0, x2 = 0;
  for (const DiscDirection& d : set) {
    const double z = height(d.p);
    second += d.weight * z * z, fourth += d.weight * z * z * z * z, side += d.weight * d.p.x, x2 += d.weight * d.p.x * d.p.x;
  }
  EXPECT_NEAR(second, 0.5, 0.5 * 0.003);
  EXPECT_NEAR(fourth, 1.0 / 3, 0.003);
  EXPECT_NEAR(side, 0, 0.002);
  EXPECT_NEAR(x2, 0.25, 0.25 * 0.003);
}

TEST(Directions, UnweightedSetIsLowAsTheThesisHasIt) {
  const auto error = [](uint32_t n) {
    double sum = 0;
    for (const DiscDirection& d : largestEmptyCircles(n, true)) sum += d.weight * height(d.p);
    return sum * 1.5 - 1;
  };
  EXPECT_NEAR(error(1024), -0.045, 0.01);  // 5 % low
  EXPECT_NEAR(error(64), -0.185, 0.02);    // 18 % low
}

TEST(Directions, LatticeIntegratesTheCosine) {
  // The shift of each texel makes it unbiased: the mean over 64 x 64 evenly spread shifts is the set's own error; and from 256 points on any
  // single shift is within a few tenths of a per cent.
  constexpr uint32_t kSide = 64;
  for (uint32_t n : counts()) {
    const std::vector<vec2> points = goldenLattice(n);
    ASSERT_EQ(points.size(), n);
    double mean = 0, worst = 0;
    const uint32_t side = n > 512 ? 16 : kSide;
    for (uint32_t s = 0; s < side * side; ++s) {
      const vec2 shift((static_cast<float>(s % side) + 0.5f) / static_cast<float>(side), (static_cast<float>(s / side) + 0.5f) / static_cast<float>(side));
      double sum = 0;
      for (vec2 p : points) {
        const vec2 q = p + shift;
        const vec2 d = shared::sampleDisc(q - glm::floor(q));
        sum += height(glm::dvec2(d)) / n;
      }
      mean += sum / (side * side);
      worst = std::max(worst, std::abs(sum * 1.5 - 1));
    }
    EXPECT_NEAR(mean * 1.5, 1, 0.002) << n;
    EXPECT_LT(worst, n >= 1024 ? 0.002 : n >= 256 ? 0.006 : 0.15) << n;
  }
}

TEST(Directions, OneAndFewWork) {
  for (uint32_t n = 1; n < 16; ++n) {
    double weights = 0;
    for (const DiscDirection& d : largestEmptyCircles(n, false)) {
      ASSERT_TRUE(std::isfinite(d.p.x) && std::isfinite(d.p.y));
      weights += d.weight;
    }
    EXPECT_NEAR(weights, 1, 1e-9);
    EXPECT_EQ(goldenLattice(n).size(), n);
  }
}

TEST(Directions, SetsGrow) {
  // A larger set starts with the smaller one: the order is that of the algorithm.
  const auto small = largestEmptyCircles(50, true), large = largestEmptyCircles(100, true);
  for (size_t i = 0; i < small.size(); ++i) EXPECT_EQ(small[i].p, large[i].p);
  // Each new point keeps the distances even: no two of 100 are close.
  double least = 9;
  for (size_t i = 4; i < large.size(); ++i)
    for (size_t j = 0; j < i; ++j) least = std::min(least, glm::length(large[i].p - large[j].p));
  EXPECT_GT(least, 0.1);
}

TEST(Directions, HilbertOrderKeepsNeighboursClose) {
  const std::vector<vec2> points = goldenLattice(1024);
  double step = 0;
  for (size_t i = 1; i < points.size(); ++i) step += static_cast<double>(glm::length(points[i] - points[i - 1])) / 1023;
  EXPECT_LT(step, 0.06);  // the lattice's own spacing is 1/32; unsorted neighbours are about 0.4 apart
}

}  // namespace
}  // namespace hl
