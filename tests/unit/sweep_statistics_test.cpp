// What runs say together, against values computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/sweep/summary.h"

namespace hl {
namespace {

TEST(Statistics, StudentsTIsThatOfTheTables) {
  // Two-sided 95 %, from printed tables.
  const std::pair<int, double> table[] = {{1, 12.7062}, {2, 4.30265}, {3, 3.18245}, {4, 2.77645}, {5, 2.57058}, {9, 2.26216}, {10, 2.22814}, {30, 2.04227}, {120, 1.97993}};
  for (const auto& [degrees, t] : table) EXPECT_NEAR(studentT95(degrees), t, 5e-5) << degrees;
  EXPECT_TRUE(std::isnan(studentT95(0)));
}

TEST(Statistics, MeanWithItsInterval) {
  const std::vector<double> v = {2, 4, 6};  // deviation 2, of the mean 2/sqrt(3)
  const Estimate e = meanOf(v);
  EXPECT_DOUBLE_EQ(e.mean, 4);
  EXPECT_NEAR(e.halfWidth, 4.30265 * 2 / std::sqrt(3.0), 1e-4);
  EXPECT_EQ(e.samples, 3);
  EXPECT_TRUE(std::isnan(meanOf(std::vector<double>{5}).halfWidth));
  EXPECT_TRUE(std::isnan(meanOf({}).mean));
}

TEST(Statistics, SpreadIsBetweenTheNearestSamples) {
  const Spread s = spreadOf({5, 1, 3, 2, 4});
  EXPECT_DOUBLE_EQ(s.median, 3);
  EXPECT_DOUBLE_EQ(s.p5, 1.2);
  EXPECT_DOUBLE_EQ(s.p95, 4.8);
  EXPECT_DOUBLE_EQ(spreadOf({}).median, 0);
}

TEST(Statistics, TheJackknifeOfAMeanIsItsOwnInterval) {
  const std::vector<double> v = {1, 5, 2, 8, 3};
  const auto mean = [&](int without) {
    double sum = 0;
    for (int i = 0; i < 5; ++i) sum += i == without ? 0 : v[static_cast<size_t>(i)];
    return sum / (without < 0 ? 5 : 4);
  };
  const Estimate a = jackknife(5, 3, mean), b = meanOf(v);
  EXPECT_NEAR(a.mean, b.mean, 1e-12);
  EXPECT_NEAR(a.halfWidth, b.halfWidth, 1e-9);
  EXPECT_TRUE(std::isnan(jackknife(2, 3, [](int) { return 1.0; }).halfWidth));
}

TEST(Pareto, OnWithinAndOff) {
  const std::vector<CostPoint> p = {{1, 10, 1, 0}, {2, 5, 1, 0}, {3, 5.5, 1, 0}, {3, 9, 1, 0}, {4, 5, 0, 0}, {2, 5, 1, 0}, {NAN, 1, 0, 0}, {9, 1, 0.1, 0}};
  const auto place = paretoFront(p);
  EXPECT_EQ(place[0], FrontPlace::On) << "the quickest";
  EXPECT_EQ(place[1], FrontPlace::On);
  EXPECT_EQ(place[2], FrontPlace::Within) << "slower and worse, but by less than the bars";
  EXPECT_EQ(place[3], FrontPlace::Off) << "5 + 1 < 9 - 1";
  EXPECT_EQ(place[4], FrontPlace::Within) << "as wrong as a quicker one";
  EXPECT_EQ(place[5], FrontPlace::On) << "the same point twice dominates nothing";
  EXPECT_EQ(place[6], FrontPlace::Off);
  EXPECT_EQ(place[7], FrontPlace::On) << "the best";
  // Surely more wrong, but whether it is dearer is not known: times overlap.
  EXPECT_EQ(paretoFront(std::vector<CostPoint>{{10, 1, 0, 2}, {11, 5, 0, 2}})[1], FrontPlace::Within);
  EXPECT_EQ(paretoFront(std::vector<CostPoint>{{10, 1, 0, 2}, {15, 5, 0, 2}})[1], FrontPlace::Off);
}

TEST(Pareto, CurvesAreStraightInBothLogarithms) {
  const std::vector<CostPoint> points = {{100, 0.04, 0, 0}, {1, 0.4, 0, 0}, {10, 0.9, 0, 0}, {50, 0.04, 0, 0}, {0, 0.1, 0, 0}, {200, -0.001, 0.0005, 0}, {300, -0.001, 0.011, 0}};
  const auto curve = lowerEnvelope(points);
  ASSERT_EQ(curve.size(), 3u) << "0.9 is no gain, 100 is later than 50, a cost of 0 and an error that is surely below 0 are nowhere";
  EXPECT_DOUBLE_EQ(curve[1].cost, 50);
  EXPECT_NEAR(curve[2].error, 0.01, 1e-12) << "the top of its interval";
  EXPECT_FALSE(errorAtCost(curve, 0.5));
  EXPECT_DOUBLE_EQ(*errorAtCost(curve, 1), 0.4);
  EXPECT_NEAR(*errorAtCost(curve, std::sqrt(50.0)), std::sqrt(0.4 * 0.04), 1e-12) << "half-way in both logarithms";
  EXPECT_NEAR(*errorAtCost(curve, 1e6), 0.01, 1e-12);
  EXPECT_DOUBLE_EQ(*costOfError(curve, 0.5), 1);
  EXPECT_NEAR(*costOfError(curve, std::sqrt(0.4 * 0.04)), std::sqrt(50.0), 1e-9);
  EXPECT_FALSE(costOfError(curve, 0.005));
  EXPECT_FALSE(errorAtCost({}, 1));
}

TEST(BiasAndVariance, OfThreeImagesByHand) {
  // Two pixels, one channel; truth 1 and 2. Seeds: (2, 2), (4, 3), (3, 4).
  std::vector<Image> images(3, Image(2, 1, 1));
  images[0].data = {2, 2}, images[1].data = {4, 3}, images[2].data = {3, 4};
  const std::vector<double> mse = {(1.0 + 0) / 2, (9.0 + 1) / 2, (4.0 + 4) / 2};
  const BiasVariance b = biasAndVariance(images, 2, mse, 0);
  EXPECT_NEAR(b.variance.mean, 1, 1e-12) << "1 at either pixel";
  // The means are 3 and 3: biases 2 and 1, squared and meant 2.5, of which a third of the variance is chance.
  EXPECT_NEAR(b.biasSquared.mean, 2.5 - 1.0 / 3, 1e-12);
  EXPECT_NEAR(b.variance.mean + b.biasSquared.mean, (0.5 + 5 + 4) / 3, 1e-12);
  // Left out in turn: seeds 2, 3: 1/2 each; 1, 3: 1/2 and 2; 1, 2: 2 and 1/2. So 0.5, 1.25, 1.25; deviation by the jackknife sqrt(2/3 * 0.375).
  EXPECT_NEAR(b.variance.halfWidth, 4.30265 * std::sqrt(2.0 / 3 * 0.375), 1e-4);
  EXPECT_TRUE(std::isnan(biasAndVariance({images[0], images[1]}, 2, {0.5, 5}, 0).variance.halfWidth));
}

/// With a known bias and noise, the intervals hold the truth about as often as they say.
TEST(BiasAndVariance, IntervalsHoldTheTruth) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, 1);
  constexpr int kTrials = 200, kSeeds = 6, kPixels = 64;
  int variance = 0, bias = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Image> images(kSeeds, Image(kPixels, 1, 1));
    std::vector<double> mse(kSeeds, 0);
    for (int s = 0; s < kSeeds; ++s)
      for (float& v : images[static_cast<size_t>(s)].data) v = 0.5f + noise(random), mse[static_cast<size_t>(s)] += static_cast<double>(v) * static_cast<double>(v) / kPixels;
    const BiasVariance b = biasAndVariance(images, kPixels, mse, 0);
    variance += std::abs(b.variance.mean - 1) < b.variance.halfWidth;
    bias += std::abs(b.biasSquared.mean - 0.25) < b.biasSquared.halfWidth;
  }
  EXPECT_GT(variance, kTrials * 0.88);
  EXPECT_LT(variance, kTrials);
  EXPECT_GT(bias, kTrials * 0.85);
}

TEST(Summary, WhatGrowsWithLikenessIsTurnedRound) {
  EXPECT_EQ(badness("psnr", 30), -30);
  EXPECT_DOUBLE_EQ(badness("ssim", 0.9), 1 - 0.9);
  EXPECT_EQ(badness("bias", -0.2), 0.2);
  EXPECT_EQ(badness("relmse", -0.2), -0.2);
}

}  // namespace
}  // namespace hl
