// Principal components of transport: the identity of the discarded singular values, and matrices that are none to speak of.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/techniques/srp/cpca.h"

namespace hl {
namespace {

/// Rows x columns with singular values that fall as `decay`^k (or as 1 / k where it is 1), in directions drawn at random, and not orthogonal: the spectrum is about that.
std::vector<float> matrixOf(uint32_t rows, uint32_t columns, uint32_t rank, double decay, uint32_t seed = 7) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> m(size_t{rows} * columns);
  for (uint32_t k = 0; k < rank; ++k) {
    const double scale = decay < 1 ? std::pow(decay, k) : 1.0 / (k + 1);
    std::vector<double> u(rows), v(columns);
    for (double& x : u) x = normal(engine);
    for (double& x : v) x = normal(engine);
    for (uint32_t r = 0; r < rows; ++r)
      for (uint32_t c = 0; c < columns; ++c) m[size_t{r} * columns + c] += scale * u[r] * v[c];
  }
  return {m.begin(), m.end()};
}

/// ||A - A_k||^2 from the matrices as they are stored.
double missing(const std::vector<float>& a, uint32_t rows, uint32_t columns, const Components& c) {
  double sum = 0;
  for (uint32_t r = 0; r < rows; ++r)
    for (uint32_t i = 0; i < columns; ++i) {
      double value = a[size_t{r} * columns + i];
      for (uint32_t k = 0; k < c.rank; ++k)
        value -= static_cast<double>(c.weights[size_t{r} * c.rank + k]) * static_cast<double>(c.basis[size_t{k} * columns + i]);
      sum += value * value;
    }
  return sum;
}

TEST(Cpca, WhatIsMissingIsWhatTheDiscardedSingularValuesSay) {
  for (const auto& [rows, columns] : {std::pair{60u, 90u}, std::pair{90u, 60u}, std::pair{300u, 200u}}) {
    const std::vector<float> a = matrixOf(rows, columns, 80, 0.8);
    ComponentSettings all;
    all.most = 10000, all.exact = true;
    const Components whole = principalComponents(a, rows, columns, all);
    double energy = 0;
    for (double s : whole.singularValues) energy += s * s;
    EXPECT_NEAR(energy / whole.total, 1, 1e-9);
    for (uint32_t most : {1u, 5u, 20u}) {
      ComponentSettings settings;
      settings.most = most, settings.exact = true;
      const Components c = principalComponents(a, rows, columns, settings);
      ASSERT_EQ(c.rank, most);
      double discarded = 0;
      for (size_t k = most; k < whole.singularValues.size(); ++k) discarded += whole.singularValues[k] * whole.singularValues[k];
      EXPECT_NEAR(c.discarded, discarded, 1e-6 * discarded) << rows << " x " << columns << ", " << most;
      EXPECT_NEAR(missing(a, rows, columns, c), discarded, 1e-6 * discarded + 1e-12 * c.total);
    }
  }
}

TEST(Cpca, TheRandomisedRangeLosesNextToNothing) {
  // A spectrum that hardly falls is the hard case.
  for (double decay : {0.95, 1.0}) {
    const std::vector<float> a = matrixOf(500, 400, 300, decay);
    ComponentSettings settings;
    settings.most = 32;
    const Components quick = principalComponents(a, 500, 400, settings);
    settings.exact = true;
    const Components exact = principalComponents(a, 500, 400, settings);
    std::printf("decay %.2f: left out %.6g of %.6g, exactly %.6g\n", decay, quick.discarded, quick.total, exact.discarded);
    EXPECT_EQ(quick.rank, exact.rank);
    EXPECT_GE(quick.discarded, exact.discarded * (1 - 1e-9));
    EXPECT_LE(quick.discarded - exact.discarded, 1e-3 * (exact.total - exact.discarded));
    EXPECT_NEAR(missing(a, 500, 400, quick), quick.discarded, 1e-6 * quick.total);
    // The same numbers again give the same bits.
    settings.exact = false;
    EXPECT_EQ(principalComponents(a, 500, 400, settings).basis, quick.basis);
  }
}

TEST(Cpca, MatricesThatAreNoneToSpeakOf) {
  const ComponentSettings settings;
  EXPECT_EQ(principalComponents({}, 0, 25, settings).rank, 0u);
  EXPECT_EQ(principalComponents({}, 3, 0, settings).rank, 0u);
  const std::vector<float> zero(12, 0.0f);
  const Components none = principalComponents(zero, 3, 4, settings);
  EXPECT_EQ(none.rank, 0u);
  EXPECT_EQ(none.discarded, 0);
  // One receiver; rank one.
  const std::vector<float> row{1, 2, 3, 4};
  const Components one = principalComponents(row, 1, 4, settings);
  ASSERT_EQ(one.rank, 1u);
  EXPECT_NEAR(missing(row, 1, 4, one), 0, 1e-10);
  const std::vector<float> outer = matrixOf(300, 250, 1, 0.5);
  const Components single = principalComponents(outer, 300, 250, settings);
  ASSERT_EQ(single.rank, 1u);
  EXPECT_LT(missing(outer, 300, 250, single), 1e-10 * single.total);
}

TEST(Cpca, AKeptLightComesOutExactly) {
  for (const auto& [rows, columns] : {std::pair{50u, 40u}, std::pair{300u, 240u}, std::pair{1u, 8u}}) {
    const std::vector<float> a = matrixOf(rows, columns, 40, 0.97);
    ComponentSettings settings;
    settings.most = 8;
    settings.keep = constantLights(a, rows, columns, 4);
    ASSERT_EQ(settings.keep.size(), 1u);
    const Components c = principalComponents(a, rows, columns, settings);
    EXPECT_LE(c.rank, 8u);
    EXPECT_NEAR(missing(a, rows, columns, c), c.discarded, 1e-6 * c.total);
    for (uint32_t r = 0; r < rows; ++r) {
      double exact = 0, kept = 0;
      for (uint32_t i = 0; i < columns; ++i) exact += static_cast<double>(a[size_t{r} * columns + i] * settings.keep[0][i]);
      for (uint32_t k = 0; k < c.rank; ++k)
        for (uint32_t i = 0; i < columns; ++i)
          kept += static_cast<double>(c.weights[size_t{r} * c.rank + k]) * static_cast<double>(c.basis[size_t{k} * columns + i] * settings.keep[0][i]);
      ASSERT_NEAR(kept, exact, 1e-4 * (std::abs(exact) + 1));
    }
    for (uint32_t k = 0; k < c.rank; ++k)
      for (uint32_t j = 0; j <= k; ++j) {
        double dot = 0;
        for (uint32_t i = 0; i < columns; ++i) dot += static_cast<double>(c.basis[size_t{k} * columns + i]) * static_cast<double>(c.basis[size_t{j} * columns + i]);
        ASSERT_NEAR(dot, k == j ? 1 : 0, 1e-5);
      }
  }
}

TEST(Cpca, WhatAsksOtherProbesIsToldNothingOfTheirLight) {
  // Two sides of a wall: receivers 0 to 9 ask probes 0 and 1, the others probes 2 to 4. Light of the first must not reach the others.
  const uint32_t rows = 60, columns = 20, coefficients = 4;
  std::vector<float> a = matrixOf(rows, columns, 20, 0.99);
  for (uint32_t r = 0; r < rows; ++r)
    for (uint32_t i = 0; i < columns; ++i)
      if ((r < 10) != (i < 8)) a[size_t{r} * columns + i] = 0;
  ComponentSettings settings;
  settings.most = 6;
  settings.keep = constantLights(a, rows, columns, coefficients);
  ASSERT_EQ(settings.keep.size(), 2u);
  // Those of most transport come first.
  EXPECT_EQ(settings.keep[0][4], 0.0f);
  EXPECT_EQ(settings.keep[0][8], 1.0f);
  EXPECT_EQ(settings.keep[1][4], 1.0f);
  const Components c = principalComponents(a, rows, columns, settings);
  for (uint32_t r = 10; r < rows; ++r)
    for (uint32_t i = 0; i < 8; ++i) {
      double value = 0;
      for (uint32_t k = 0; k < c.rank; ++k) value += static_cast<double>(c.weights[size_t{r} * c.rank + k]) * static_cast<double>(c.basis[size_t{k} * columns + i]);
      ASSERT_NEAR(value, 0, 1e-6);
    }
}

TEST(Cpca, KeptLightsLeaveRoomForComponents) {
  // Each receiver asks one probe of its own, and three probes are asked by none: 12 groups for 8 vectors.
  const uint32_t probes = 15, coefficients = 4, rows = 48, columns = probes * coefficients;
  std::vector<float> a = matrixOf(rows, columns, 40, 0.99);
  for (uint32_t r = 0; r < rows; ++r)
    for (uint32_t i = 0; i < columns; ++i)
      if (i / coefficients != r % 12) a[size_t{r} * columns + i] = 0;
  ComponentSettings settings;
  settings.most = 8;
  settings.keep = constantLights(a, rows, columns, coefficients);
  EXPECT_EQ(settings.keep.size(), 12u);
  const Components kept = principalComponents(a, rows, columns, settings);
  EXPECT_EQ(kept.rank, 8u);
  EXPECT_EQ(kept.singularValues.size(), 4u);
  settings.keep.clear();
  const Components plain = principalComponents(a, rows, columns, settings);
  EXPECT_LT(kept.discarded, 1.25 * plain.discarded);
}

TEST(Cpca, ATolerancePicksTheRank) {
  const std::vector<float> a = matrixOf(200, 180, 60, 0.7);
  ComponentSettings settings;
  settings.most = 64;
  uint32_t before = 64;
  for (double tolerance : {0.001, 0.01, 0.1, 0.5}) {
    settings.tolerance = tolerance;
    const Components c = principalComponents(a, 200, 180, settings);
    EXPECT_LE(std::sqrt(c.discarded / c.total), tolerance * (1 + 1e-6));
    EXPECT_LE(c.rank, before);
    // One vector fewer would be too few.
    ASSERT_GT(c.rank, 0u);
    const double last = c.singularValues.back();
    EXPECT_GT(std::sqrt((c.discarded + last * last) / c.total), tolerance);
    before = c.rank;
  }
}

}  // namespace
}  // namespace hl
