// The estimate free of the reference's variance, its floor, and the standard error: checked on synthetic noise over
// many seeds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "engine/metrics/block_mean.h"
#include "engine/metrics/metrics.h"

namespace hl {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr float kTruth = 2.0f;
constexpr float kOffset = 0.05f;    // what the value is wrong by
constexpr float kHalfSigma = 0.4f;  // of each half
constexpr double kTrueMse = kOffset * kOffset;
constexpr double kReferenceVariance = kHalfSigma * kHalfSigma / 2;  // of the mean of two halves
constexpr int kSeeds = 200;

Image noisy(float mean, float sigma, std::mt19937& random) {
  Image image(kWidth, kHeight, 3);
  std::normal_distribution<float> noise(mean, sigma);
  for (float& value : image.data) value = noise(random);
  return image;
}

ReferenceImage noisyReference(std::mt19937& random, float sigma = kHalfSigma) {
  ReferenceImage reference{{}, noisy(kTruth, sigma, random), noisy(kTruth, sigma, random)};
  reference.mean = reference.halfA;
  for (size_t i = 0; i < reference.mean.data.size(); ++i)
    reference.mean.data[i] = 0.5f * (reference.halfA.data[i] + reference.halfB.data[i]);
  return reference;
}

/// Dark enough for the metrics of appearance to see the noise, which a white picture would swallow.
MeasureOptions dimmed() {
  MeasureOptions options;
  options.appearance.exposure = -3;
  return options;
}

struct Statistics {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) { sum += x, squares += x * x, ++count; }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt((squares / count - mean() * mean()) * count / (count - 1)); }
  double errorOfMean() const { return deviation() / std::sqrt(count); }
};

TEST(NoiseFloor, HalvesTakeTheReferencesVarianceOut) {
  Image value(kWidth, kHeight, 3);
  for (float& x : value.data) x = kTruth + kOffset;
  Statistics unbiased, naive, floor, claimed;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random(seed);
    const ReferenceImage reference = noisyReference(random);
    const MetricResult result = measure("mse", value, reference);
    unbiased.add(result.value);
    floor.add(result.noiseFloor);
    claimed.add(result.standardError);
    naive.add(measure("mse", value, {reference.mean, {}, {}}).value);
  }
  EXPECT_NEAR(unbiased.mean(), kTrueMse, 4 * unbiased.errorOfMean());
  EXPECT_NEAR(naive.mean(), kTrueMse + kReferenceVariance, 4 * naive.errorOfMean());
  EXPECT_NEAR(floor.mean(), kReferenceVariance, 4 * floor.errorOfMean());
  // So that the first line can fail: the variance it leaves out is many of its errors.
  EXPECT_GT(kReferenceVariance, 50 * unbiased.errorOfMean());
  // The standard error of one run is the spread over runs.
  EXPECT_NEAR(claimed.mean() / unbiased.deviation(), 1, 0.2);
}

// A value whose error is all in one corner: the reference's noise decides how well the error is known, not where in the picture it is.
TEST(NoiseFloor, StandardErrorIsTheReferencesNotThePictures) {
  Image value(kWidth, kHeight, 3);
  for (float& x : value.data) x = kTruth;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) value.data[static_cast<size_t>((y * kWidth + x) * 3 + c)] += 20 * kHalfSigma;
  for (const MetricInfo& info : metricInfos()) {
    if (info.id == "psnr" || info.id == "rmse") continue;  // follow mse to first order, which is tested below
    if (info.id == "relmse") continue;                     // has noise below the line too: the next test
    if (info.windowed) continue;                           // say that it is not known
    Statistics values, claimed, picture;
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      std::mt19937 random(seed);
      const ReferenceImage reference = noisyReference(random);
      const MetricResult result = measure(info.id, value, reference, dimmed());
      values.add(result.value);
      claimed.add(result.standardError);
      picture.add(measure(info.id, value, {reference.mean, {}, {}}, dimmed()).standardError);
    }
    if (info.squared) {
      EXPECT_NEAR(claimed.mean() / values.deviation(), 1, 0.2) << info.id;
    } else {
      // |v - r| about v = r folds the noise, and its spread with it: the draw is an upper bound there.
      EXPECT_GT(claimed.mean() / values.deviation(), 0.8) << info.id;
      EXPECT_LT(claimed.mean() / values.deviation(), 2) << info.id;
    }
    EXPECT_GT(picture.mean(), 3 * claimed.mean()) << info.id;
  }
}

// Of relmse too, where pixels are certain of their denominators and where they take them from their neighbours; between the two, where noise decides which
// pixel does what, it may fall short by half. (The error here is four times the light, so that all noise is below the line.)
TEST(NoiseFloor, StandardErrorOfRelmse) {
  Image value(kWidth, kHeight, 3);
  for (float& x : value.data) x = kTruth;
  for (int i = 0; i < 16; ++i)
    for (int c = 0; c < 3; ++c) value.pixel(i % 4 * 9, i / 4 * 9)[c] += 4 * kTruth;
  for (const auto& [sigma, least, most] : {std::tuple{0.1f, 0.8, 1.25}, {0.4f, 0.5, 1.25}, {1.0f, 0.8, 1.25}}) {
    Statistics values, claimed;
    for (unsigned seed = 0; seed < 100; ++seed) {
      std::mt19937 random(seed);
      const MetricResult result = measure("relmse", value, noisyReference(random, sigma));
      values.add(result.value);
      claimed.add(result.standardError);
    }
    std::printf("relative noise %.2f: claimed %.4f, spread %.4f of %.4f\n", static_cast<double>(sigma / kTruth) / std::sqrt(2), claimed.mean(), values.deviation(),
                values.mean());
    EXPECT_GT(claimed.mean() / values.deviation(), least) << sigma;
    EXPECT_LT(claimed.mean() / values.deviation(), most) << sigma;
  }
}

// The floor is the reference's variance over the same denominator, and the value is what it is off by over it, however noisy the reference is.
TEST(NoiseFloor, RelmseAndItsFloorShareTheDenominator) {
  constexpr float kSigma = 3 * kHalfSigma;
  Image value(kWidth, kHeight, 3);
  for (float& x : value.data) x = 2 * kTruth;
  const double denominator = kTruth * kTruth * (1 + 0.01 * 0.01), variance = kSigma * kSigma / 2;
  Statistics values, floors;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const MetricResult relmse = measure("relmse", value, noisyReference(random, kSigma));
    values.add(relmse.value * denominator / (kTruth * kTruth)), floors.add(relmse.noiseFloor * denominator / variance);
  }
  std::printf("of what it should be: value %.4f +- %.4f, floor %.4f +- %.4f\n", values.mean(), values.errorOfMean(), floors.mean(), floors.errorOfMean());
  EXPECT_NEAR(values.mean(), 1, 0.02 + 3 * values.errorOfMean());
  EXPECT_NEAR(floors.mean(), 1, 0.1 + 3 * floors.errorOfMean());
}

// Two images are divided by the same: the value is a quadratic function of the image, whose second difference in one direction is the same about any image.
TEST(Denominator, RestsOnTheReferenceAlone) {
  std::mt19937 random(7);
  const ReferenceImage reference = noisyReference(random, 3 * kHalfSigma);
  const Image direction = noisy(0, 0.3f, random);
  const double epsilon = measure("relmse", direction, reference).epsilon;
  const auto secondDifference = [&](const Image& about) {
    Image up = about, down = about;
    for (size_t i = 0; i < about.data.size(); ++i) up.data[i] += direction.data[i], down.data[i] -= direction.data[i];
    return measure("relmse", up, reference).value + measure("relmse", down, reference).value - 2 * measure("relmse", about, reference).value;
  };
  Image flat(kWidth, kHeight, 3), edges(kWidth, kHeight, 3);
  for (float& x : flat.data) x = kTruth;
  for (size_t i = 0; i < edges.data.size(); ++i) edges.data[i] = i / 21 % 2 ? 20 * kTruth : 0.01f;
  const Image far = noisy(5 * kTruth, kTruth, random);
  const double expected = secondDifference(flat);
  EXPECT_GT(expected, 0);
  EXPECT_GT(epsilon, 0);
  EXPECT_NEAR(secondDifference(edges), expected, 1e-3 * expected);
  EXPECT_NEAR(secondDifference(far), expected, 1e-3 * expected);
  // And it is what stands below the mean of squares: the pixel's own noise at most a small share of it.
  double squares = 0;
  for (const float d : direction.data) squares += static_cast<double>(d * d) / static_cast<double>(direction.data.size());
  EXPECT_NEAR(expected, 2 * squares / (kTruth * kTruth), 0.1 * expected);
}

TEST(NoiseFloor, FollowsTheMetricsUnit) {
  std::mt19937 random(2);
  const Image value = noisy(kTruth, 0.3f, random);
  const ReferenceImage reference = noisyReference(random);
  const MetricResult mse = measure("mse", value, reference), rmse = measure("rmse", value, reference),
                     psnr = measure("psnr", value, reference);
  EXPECT_NEAR(rmse.value * rmse.value, mse.value, 1e-12);
  EXPECT_NEAR(rmse.noiseFloor * rmse.noiseFloor, mse.noiseFloor, 1e-12);
  const double peak = psnr.peak * psnr.peak;
  EXPECT_NEAR(peak / std::pow(10, psnr.value / 10), mse.value, 1e-9);
  EXPECT_NEAR(peak / std::pow(10, psnr.noiseFloor / 10), mse.noiseFloor, 1e-9);
  // First order: one standard error up in the square is one up in the root and one down in decibels.
  const double step = mse.standardError / 100;
  EXPECT_NEAR(rmse.standardError, 100 * (std::sqrt(mse.value + step) - std::sqrt(mse.value)),
              1e-3 * rmse.standardError);
  EXPECT_NEAR(psnr.standardError, 1000 * std::log10(1 + step / mse.value), 1e-3 * psnr.standardError);
}

TEST(NoiseFloor, MetricsThatAreNotSquaredSayNone) {
  std::mt19937 random(3);
  const Image value = noisy(kTruth, 0.3f, random);
  const ReferenceImage reference = noisyReference(random);
  for (const MetricInfo& info : metricInfos()) {
    const MetricResult result = measure(info.id, value, reference, dimmed());
    EXPECT_EQ(info.squared, std::isfinite(result.noiseFloor)) << info.id;
    EXPECT_EQ(info.windowed, std::isnan(result.standardError)) << info.id;
    if (!info.squared) {
      EXPECT_EQ(result.value, measure(info.id, value, {reference.mean, {}, {}}, dimmed()).value) << info.id;
    }
  }
}

TEST(NoiseFloor, AnErrorBelowTheNoiseIsNoneAndNotNan) {
  // The value is the truth: about half of all seeds estimate a square below 0.
  Image value(kWidth, kHeight, 3);
  for (float& x : value.data) x = kTruth;
  int below = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const ReferenceImage reference = noisyReference(random);
    const double mse = measure("mse", value, reference).value;
    const MetricResult rmse = measure("rmse", value, reference), psnr = measure("psnr", value, reference);
    EXPECT_FALSE(std::isnan(rmse.value) || std::isnan(psnr.value));
    EXPECT_GT(rmse.standardError, 0);
    if (mse >= 0) continue;
    ++below;
    EXPECT_EQ(rmse.value, 0);
    EXPECT_EQ(psnr.value, std::numeric_limits<double>::infinity());
    EXPECT_EQ(psnr.standardError, std::numeric_limits<double>::infinity());
  }
  EXPECT_GT(below, 2);
  EXPECT_LT(below, 18);
}

/// What few paths bring back: most find nothing. Mean `truth`, heavy-tailed.
float fewPaths(float truth, int paths, std::mt19937& random) {
  constexpr float kHitShare = 0.05f;
  std::binomial_distribution<int> hits(paths, static_cast<double>(kHitShare));
  return truth * static_cast<float>(hits(random)) / (kHitShare * static_cast<float>(paths));
}

/// A scene with a bright and a dark part and a ramp between, seen by so many paths a half.
ReferenceImage fewPathsReference(int paths, std::mt19937& random) {
  ReferenceImage out{Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3)};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        const float truth = x < 20 ? 2.0f : x < 40 ? 2.0f - static_cast<float>(x - 20) * 0.09f : 0.2f;
        float &a = out.halfA.pixel(x, y)[c], &b = out.halfB.pixel(x, y)[c];
        a = paths > 0 ? fewPaths(truth, paths, random) : truth, b = paths > 0 ? fewPaths(truth, paths, random) : truth;
        out.mean.pixel(x, y)[c] = (a + b) / 2;
      }
  return out;
}

// Where few paths leave some pixels of the reference next to black, 1 / r^2 there outweighs all the rest, and the value has nothing to do with the error.
TEST(Denominator, OfANoisyReferenceLeavesTheValueNearItsTruth) {
  std::mt19937 random(5);
  const ReferenceImage exact = fewPathsReference(0, random);
  Image value = exact.mean;
  for (size_t i = 0; i < value.data.size(); ++i) value.data[i] *= i % 5 == 0 ? 1.1f : 0.97f;
  const double truth = measure("relmse", value, exact).value;
  for (const int paths : {16, 64, 256, 1024}) {
    Statistics values, uncalmed;
    for (unsigned seed = 0; seed < 40; ++seed) {
      random.seed(seed);
      const ReferenceImage noisy = fewPathsReference(paths, random);
      values.add(measure("relmse", value, noisy).value);
      double sum = 0;
      const double e = measure("relmse", value, noisy).epsilon;
      for (size_t i = 0; i < value.data.size(); ++i)
        sum += static_cast<double>((value.data[i] - noisy.halfA.data[i]) * (value.data[i] - noisy.halfB.data[i])) /
               (static_cast<double>(noisy.mean.data[i] * noisy.mean.data[i]) + e * e);
      uncalmed.add(sum / static_cast<double>(value.data.size()));
    }
    std::printf("%4d paths a half: truth %.5f, estimate %.5f +- %.5f, with the noisy denominator %.5f\n", paths, truth, values.mean(), values.errorOfMean(),
                uncalmed.mean());
    EXPECT_NEAR(values.mean(), truth, 0.15 * truth + 4 * values.errorOfMean()) << paths;
    if (paths <= 64) {
      EXPECT_GT(std::fabs(uncalmed.mean() - truth), 10 * std::fabs(values.mean() - truth)) << paths;
    }
  }
}

// A dark surface beside a bright one, wrong along the line where they meet: there neighbours mislead, unless it is known which of them lie on the same surface.
TEST(Denominator, KeepsToThePixelsOwnSurface) {
  constexpr int kLine = kWidth / 2;
  constexpr float kBright = 2, kDark = 0.2f;
  constexpr int kPaths = 16;  // so few that a dark pixel could be one by luck
  ReferenceSurfaces surfaces{Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3), {}, {}};
  Image value(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool bright = x < kLine;
      // A floor that meets a wall: in the corner both have x = 0.
      float *position = surfaces.position.pixel(x, y), *normal = surfaces.normal.pixel(x, y), *v = value.pixel(x, y);
      const float along = static_cast<float>(x - kLine) + 0.5f;
      position[0] = bright ? along : 0, position[1] = bright ? 0 : along, position[2] = static_cast<float>(y);
      normal[bright ? 1 : 0] = bright ? 1.0f : -1.0f;
      for (int c = 0; c < 3; ++c) v[c] = bright ? kBright : x == kLine ? 3 * kDark : kDark;
    }
  Statistics known, unknown;
  double truth = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    ReferenceImage reference{Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3), Image(kWidth, kHeight, 3)}, exact = reference;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < 3; ++c) {
          const float level = x < kLine ? kBright : kDark;
          float &a = reference.halfA.pixel(x, y)[c], &b = reference.halfB.pixel(x, y)[c];
          a = fewPaths(level, kPaths, random), b = fewPaths(level, kPaths, random);
          reference.mean.pixel(x, y)[c] = (a + b) / 2, exact.mean.pixel(x, y)[c] = level;
        }
    truth = measure("relmse", value, {exact.mean, {}, {}}).value;
    unknown.add(measure("relmse", value, reference).value);
    reference.surfaces = std::make_shared<const ReferenceSurfaces>(surfaces);
    known.add(measure("relmse", value, reference).value);
  }
  std::printf("truth %.4f, surfaces known %.4f +- %.4f, unknown %.4f +- %.4f\n", truth, known.mean(), known.errorOfMean(), unknown.mean(), unknown.errorOfMean());
  EXPECT_NEAR(known.mean(), truth, 0.15 * truth + 3 * known.errorOfMean());
  EXPECT_LT(unknown.mean(), 0.6 * truth);
}

// One dark pixel in a bright surface, as where another object covers it. It cannot be dark by luck: so it is believed long before the reference is certain of it.
TEST(Denominator, BelievesAPixelThatCannotBeDarkByLuck) {
  constexpr float kDark = 0.02f, kBright = 2;
  Image value(kWidth, kHeight, 3);
  for (float& x : value.data) x = kBright;
  Statistics estimates;
  double truth = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    ReferenceImage reference{value, value, value}, exact{value, {}, {}};
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < 3; ++c) {
          const float level = x % 8 == 4 && y % 8 == 4 ? kDark : kBright;
          float &a = reference.halfA.pixel(x, y)[c], &b = reference.halfB.pixel(x, y)[c];
          a = fewPaths(level, 1024, random), b = fewPaths(level, 1024, random);
          reference.mean.pixel(x, y)[c] = (a + b) / 2, exact.mean.pixel(x, y)[c] = level;
        }
    truth = measure("relmse", value, exact).value;
    estimates.add(measure("relmse", value, reference).value);
  }
  std::printf("truth %.2f, estimate %.2f +- %.2f\n", truth, estimates.mean(), estimates.errorOfMean());
  EXPECT_NEAR(estimates.mean(), truth, 0.1 * truth + 3 * estimates.errorOfMean());
}

TEST(Denominator, OfAConvergedReferenceIsThePlainOne) {
  std::mt19937 random(6);
  ReferenceImage reference = fewPathsReference(0, random);
  const Image value = fewPathsReference(64, random).mean;
  const double plain = measure("relmse", value, {reference.mean, {}, {}}).value;
  EXPECT_NEAR(measure("relmse", value, reference).value, plain, 1e-6 * plain);
  std::normal_distribution<float> noise(1, 0.003f);
  for (size_t i = 0; i < value.data.size(); ++i) {
    reference.halfA.data[i] *= noise(random), reference.halfB.data[i] *= noise(random);
    reference.mean.data[i] = (reference.halfA.data[i] + reference.halfB.data[i]) / 2;
  }
  EXPECT_NEAR(measure("relmse", value, reference).value, plain, 0.01 * plain);
}

TEST(StandardError, IsTheSpreadOverSeedsOfIndependentNoise) {
  Statistics means, claimed;
  const std::vector<double> weights(kWidth * kHeight, 1.0);
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(1.0, 0.5);
    std::vector<double> values(kWidth * kHeight);
    for (double& x : values) x = noise(random);
    const BlockMean result = blockMean(values, weights, kWidth, kHeight);
    means.add(result.mean);
    claimed.add(result.standardError);
  }
  EXPECT_NEAR(means.mean(), 1.0, 4 * means.errorOfMean());
  EXPECT_NEAR(claimed.mean() / means.deviation(), 1, 0.2);
}

// Neighbours that share their error are one piece of evidence, not many: pixel by pixel the error would come out a
// quarter as large.
TEST(StandardError, SeesThatNeighboursAreNotIndependent) {
  constexpr int kTile = 4, kEdge = 128;
  Statistics means, claimed, pixelByPixel;
  const std::vector<double> weights(kEdge * kEdge, 1.0);
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(1.0, 0.5);
    std::vector<double> values(kEdge * kEdge);
    Statistics pixels;
    for (int y = 0; y < kEdge; y += kTile)
      for (int x = 0; x < kEdge; x += kTile) {
        const double shared = noise(random);
        for (int i = 0; i < kTile * kTile; ++i) {
          values[static_cast<size_t>((y + i / kTile) * kEdge + x + i % kTile)] = shared;
          pixels.add(shared);
        }
      }
    const BlockMean result = blockMean(values, weights, kEdge, kEdge);
    means.add(result.mean);
    claimed.add(result.standardError);
    pixelByPixel.add(pixels.errorOfMean());
  }
  EXPECT_NEAR(claimed.mean() / means.deviation(), 1, 0.25);
  EXPECT_LT(pixelByPixel.mean() / means.deviation(), 0.4);
}

TEST(StandardError, OfFewPixelsUsesSmallerBlocks) {
  std::vector<double> values(8 * 8), weights(8 * 8, 1.0);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i % 5);
  const BlockMean small = blockMean(values, weights, 8, 8);
  EXPECT_GT(small.standardError, 0);
  EXPECT_TRUE(std::isfinite(small.standardError));
  std::fill(weights.begin(), weights.end(), 0.0);
  weights[9] = 2;
  const BlockMean one = blockMean(values, weights, 8, 8);
  EXPECT_EQ(one.mean, values[9]);
  EXPECT_EQ(one.standardError, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace hl
