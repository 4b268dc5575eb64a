// Metrics of appearance, and what windows see: closed forms, small pictures, masks and regions; maps against values over the whole registry.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/core/error.h"
#include "engine/core/task_pool.h"
#include "engine/metrics/metrics.h"
#include "engine/metrics/separable_filter.h"

namespace hl {
namespace {

Image constant(int width, int height, vec3 colour) {
  Image out(width, height, 3);
  for (size_t i = 0; i < out.pixels(); ++i)
    for (int c = 0; c < 3; ++c) out.data[3 * i + static_cast<size_t>(c)] = colour[c];
  return out;
}

Image noisy(int width, int height, unsigned seed) {
  Image out(width, height, 3);
  std::mt19937 random(seed);
  std::lognormal_distribution<float> light(-1.5f, 1.0f);
  for (float& x : out.data) x = light(random);
  return out;
}

double value(const char* metric, const Image& v, const Image& r, const MeasureOptions& options = {}) {
  return measure(metric, v, {r, {}, {}}, options).value;
}

TEST(Picture, ConstantPicturesHaveClosedForms) {
  MeasureOptions stored;
  stored.appearance.stored = true;
  const Image dark = constant(20, 16, vec3(0.25f)), bright = constant(20, 16, vec3(0.75f));
  EXPECT_NEAR(value("ssim", bright, dark, stored), (2 * 0.25 * 0.75 + 1e-4) / (0.25 * 0.25 + 0.75 * 0.75 + 1e-4), 1e-5);
  // Black and white: 100 apart in lightness alone. The scale's end is blue against green: 203.3 apart.
  const Image black = constant(20, 16, vec3(0)), white = constant(20, 16, vec3(1));
  const double most = std::pow(203.30, 0.7), knee = 0.4 * most;
  EXPECT_NEAR(value("flip", white, black), 0.95 + 0.05 * (std::pow(100, 0.7) - knee) / (most - knee), 1e-4);
  EXPECT_NEAR(value("flip", constant(20, 16, vec3(0, 1, 0)), constant(20, 16, vec3(0, 0, 1))), 1, 1e-5);
  // CIE 1976: L* = 116 Y^(1/3) - 16, and 903.3 Y below 0.008856.
  const double mid = 1.16 * std::cbrt(0.18) - 0.16, half = 1.16 * std::cbrt(0.5) - 0.16;
  EXPECT_NEAR(value("l_star_mse", constant(9, 9, vec3(0.18f)), constant(9, 9, vec3(0.5f))), (mid - half) * (mid - half), 1e-6);
  EXPECT_NEAR(value("l_star_mse", constant(9, 9, vec3(0.004f)), constant(9, 9, vec3(0)), stored), std::pow(9.033 * 0.004 / 12.92, 2), 1e-8);
  EXPECT_NEAR(value("l_star_mse", white, black), 1, 1e-6);
  EXPECT_NEAR(value("dfpr", white, black), std::sqrt(3.0), 1e-6);
  MeasureOptions brighter;
  brighter.appearance.exposure = 1;
  EXPECT_NEAR(value("dfpr", white, black, brighter), 2 * std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(value("dfpr", constant(9, 9, vec3(0.3f, 0, 0.4f)), constant(9, 9, vec3(0))), 0.5, 1e-6);
}

TEST(Picture, StoredPicturesAreThoseThatTheScreenShows) {
  const Image r = noisy(30, 20, 1), v = noisy(30, 20, 2);
  MeasureOptions light, stored;
  light.appearance.exposure = 0.7f, light.appearance.curve = shared::kToneMapAces;
  stored.appearance.stored = true;
  Image shownR = r, shownV = v;
  const Screen screen(light.appearance);
  for (float& x : shownR.data) x = screen.signal(x);
  for (float& x : shownV.data) x = screen.signal(x);
  for (const char* metric : {"ssim", "flip", "l_star_mse"}) {
    EXPECT_NEAR(value(metric, v, r, light), value(metric, shownV, shownR, stored), 1e-5) << metric;
    EXPECT_GT(std::fabs(value(metric, v, r, light) - value(metric, v, r)), 1e-3) << metric;  // the curve matters
  }
}

TEST(Picture, AnySizeHasAValue) {
  TaskPool pool(2);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {3, 2}, {10, 11}, {40, 3}}) {
    const Image r = noisy(width, height, 3), v = noisy(width, height, 4);
    for (const MetricInfo& info : metricInfos()) {
      const double apart = measure(info.id, v, {r, {}, {}}).value;
      EXPECT_TRUE(std::isfinite(apart)) << info.id << " " << width << " x " << height;
      EXPECT_NE(apart, info.perfect) << info.id;
      EXPECT_EQ(measure(info.id, r, {r, {}, {}}).value, info.perfect) << info.id << " " << width << " x " << height;
      MeasureOptions shared;
      shared.pool = &pool;
      EXPECT_EQ(measure(info.id, v, {r, {}, {}}, shared).value, apart) << info.id << ": the pool changes nothing";
    }
  }
}

TEST(Picture, ExposuresOfHdrFlipComeFromTheReference) {
  const Image r = noisy(40, 30, 5), v = noisy(40, 30, 6);
  Image darkR = r, darkV = v;
  for (float& x : darkR.data) x /= 4096;
  for (float& x : darkV.data) x /= 4096;
  EXPECT_NEAR(value("flip_hdr", darkV, darkR), value("flip_hdr", v, r), 1e-5);
  MeasureOptions exposed;
  exposed.appearance.exposure = 5;
  EXPECT_EQ(value("flip_hdr", v, r, exposed), value("flip_hdr", v, r));
  // A black reference has no exposure of its own, and one that is black in most places none for its median.
  const Image black = constant(40, 30, vec3(0));
  EXPECT_EQ(value("flip_hdr", black, black), 0);
  EXPECT_TRUE(std::isfinite(value("flip_hdr", v, black)));
  Image mostlyBlack = r;
  std::fill_n(mostlyBlack.data.begin(), 40 * 20 * 3, 0.0f);
  EXPECT_GT(value("flip_hdr", v, mostlyBlack), 0.1);
  Image negative = v;
  for (float& x : negative.data) x = -x;
  EXPECT_TRUE(std::isfinite(value("flip_hdr", negative, r)));
}

TEST(Picture, ARegionsValueIsTheMapsMeanThere) {
  constexpr int kWidth = 50, kHeight = 40;
  const Image r = noisy(kWidth, kHeight, 7), v = noisy(kWidth, kHeight, 8);
  MeasureOptions options;
  options.wantMap = true;
  options.mask.assign(kWidth * kHeight, 1);
  for (size_t i = 0; i < options.mask.size(); i += 7) options.mask[i] = 0;
  for (size_t i = 0; i < options.mask.size(); ++i) options.weights.push_back(1 + static_cast<float>(i % 3));
  const Mask regions[] = {{}, rectangleMask(kWidth, kHeight, {10, 5, 12, 9}), rectangleMask(kWidth, kHeight, {0, 39, 50, 1})};
  for (const MetricInfo& info : metricInfos()) {
    const auto results = measureRegions(info.id, v, {r, {}, {}}, options, regions);
    ASSERT_EQ(results.size(), 3u);
    for (size_t k = 0; k < 3; ++k) {
      double sum = 0, weight = 0;
      for (size_t i = 0; i < options.mask.size(); ++i) {
        const bool counts = options.mask[i] && (regions[k].empty() || regions[k][i]);
        // Windows see past the region, so that its map is a part of the whole one.
        const float mapped = results[k].map.data[i];
        if (!counts) {
          EXPECT_EQ(mapped, 0);
          continue;
        }
        if (info.windowed) {
          EXPECT_EQ(mapped, results[0].map.data[i]) << info.id;
        }
        const double term = info.id == "rmse" ? static_cast<double>(mapped) * static_cast<double>(mapped) : static_cast<double>(mapped);
        sum += static_cast<double>(options.weights[i]) * term, weight += static_cast<double>(options.weights[i]);
      }
      double told = results[k].value;
      if (info.id == "rmse") told *= told;
      if (info.id == "psnr") told = results[k].peak * results[k].peak / std::pow(10, told / 10);
      EXPECT_NEAR(sum / weight, told, 1e-6 * std::fabs(told)) << info.id;
    }
    EXPECT_NE(results[1].value, results[0].value) << info.id;
  }
  const Mask nowhere(kWidth * kHeight, 0), wrongSize(3, 1);
  EXPECT_THROW(measureRegions("mse", v, {r, {}, {}}, options, {&nowhere, 1}), Error);
  EXPECT_THROW(measureRegions("mse", v, {r, {}, {}}, options, {&wrongSize, 1}), Error);
}

TEST(Picture, WindowsDoNotSeeWhatDoesNotCount) {
  const Image r = noisy(40, 30, 9), v = noisy(40, 30, 10);
  MeasureOptions options;
  options.wantMap = true;
  options.mask = rectangleMask(40, 30, {0, 0, 40, 15});
  Image other = v;
  for (size_t i = 40 * 15 * 3; i < other.data.size(); ++i) other.data[i] = i % 2 ? 1e30f : -std::numeric_limits<float>::infinity();
  for (const MetricInfo& info : metricInfos()) {
    const MetricResult one = measure(info.id, v, {r, {}, {}}, options), two = measure(info.id, other, {r, {}, {}}, options);
    EXPECT_EQ(one.value, two.value) << info.id;
    EXPECT_EQ(two.nonFinite, 0u);
  }
  // A pixel that counts and is not finite is NaN in the map, and its neighbours are not.
  other = v;
  other.pixel(5, 5)[1] = std::numeric_limits<float>::quiet_NaN();
  const MetricResult bad = measure("flip", other, {r, {}, {}}, options);
  EXPECT_TRUE(std::isnan(bad.value));
  EXPECT_EQ(bad.nonFinite, 1u);
  for (int x = 0; x < 12; ++x) EXPECT_EQ(std::isnan(*bad.map.pixel(x, 5)), x == 5);
}

TEST(Picture, GreyIsThreeEqualChannelsAndTwoAreRefused) {
  Image grey(20, 14, 1), otherGrey(20, 14, 1), r(20, 14, 3), v(20, 14, 3);
  const Image a = noisy(20, 14, 11), b = noisy(20, 14, 12);
  for (size_t i = 0; i < grey.pixels(); ++i) {
    grey.data[i] = a.data[3 * i], otherGrey.data[i] = b.data[3 * i];
    for (size_t c = 0; c < 3; ++c) r.data[3 * i + c] = grey.data[i], v.data[3 * i + c] = otherGrey.data[i];
  }
  for (const char* metric : {"ssim", "flip", "flip_hdr"}) {
    EXPECT_EQ(value(metric, otherGrey, grey), value(metric, v, r)) << metric;
    EXPECT_THROW(value(metric, Image(4, 4, 2), Image(4, 4, 2)), Error);
  }
  EXPECT_NEAR(value("l_star_mse", otherGrey, grey), value("l_star_mse", v, r), 1e-6);
}

TEST(SeparableFilter, MirrorsWithItsBorderRepeated) {
  const int expected[] = {1, 2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0};
  for (int i = -5; i < 7; ++i) EXPECT_EQ(borderIndex(i, 3, Border::Mirror), expected[i + 5]) << i;
  for (int i = -30; i < 30; ++i) EXPECT_EQ(borderIndex(i, 1, Border::Mirror), 0);
  EXPECT_EQ(borderIndex(-4, 3, Border::Clamp), 0);
  EXPECT_EQ(borderIndex(9, 3, Border::Clamp), 2);
}

TEST(SeparableFilter, KeepsTheMeanOfAConstantAndTheOrderOfTaps) {
  const Plane in = {1, 2, 3, 4, 5, 6};
  const std::vector<float> taps = {0, 0, 1};  // the right neighbour, or the lower one
  EXPECT_EQ(filterRows(in, 3, 2, taps, Border::Clamp, nullptr), (Plane{2, 3, 3, 5, 6, 6}));
  EXPECT_EQ(filterColumns(in, 3, 2, taps, Border::Clamp, nullptr), (Plane{4, 5, 6, 4, 5, 6}));
  const std::vector<float> gaussian = inFloat(gaussianTaps(1.5, 5));
  ASSERT_EQ(gaussian.size(), 11u);
  for (const float x : filterRows(Plane(7 * 3, 2.0f), 7, 3, gaussian, Border::Mirror, nullptr)) EXPECT_NEAR(x, 2, 1e-6);
}

}  // namespace
}  // namespace hl
