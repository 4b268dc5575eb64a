// The metrics' values against figures worked out by hand and against OpenImageIO's own arithmetic.
#include "engine/metrics/metrics.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include "engine/core/error.h"

namespace hl {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// HDR-like: a few bright pixels, some black ones.
Image randomImage(int width, int height, int channels, unsigned seed) {
  Image image(width, height, channels);
  std::mt19937 random(seed);
  std::lognormal_distribution<float> bright(0.0f, 1.5f);
  for (float& value : image.data) value = random() % 20 == 0 ? 0.0f : bright(random);
  return image;
}

/// `image` with relative noise.
Image disturbed(const Image& image, unsigned seed) {
  Image out = image;
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(1.02f, 0.2f);
  for (float& value : out.data) value = value * noise(random) + 0.001f;
  return out;
}

ReferenceImage plain(const Image& mean) { return {.mean = mean, .halfA = {}, .halfB = {}}; }

OIIO::ImageBuf bufferOf(Image& image) {
  return OIIO::ImageBuf(OIIO::ImageSpec(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT),
                        image.data.data());
}

double meanOf(const OIIO::ImageBuf& buffer) {
  const auto stats = OIIO::ImageBufAlgo::computePixelStats(buffer);
  return std::accumulate(stats.avg.begin(), stats.avg.end(), 0.0) / static_cast<double>(stats.avg.size());
}

double meanLuminance(const Image& r) {
  double sum = 0;
  for (size_t i = 0; i < r.pixels(); ++i)
    sum += 0.2126 * r.data[3 * i] + 0.7152 * r.data[3 * i + 1] + 0.0722 * r.data[3 * i + 2];
  return sum / static_cast<double>(r.pixels());
}

std::string messageOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BadInput);
    return error.what();
  }
  ADD_FAILURE() << "no error was thrown";
  return "";
}

// Two grey pixels, r = (1, 3), v = (2, 2): the mean luminance is 2, e = 0.02.
TEST(Metrics, AgreeWithFiguresByHand) {
  Image v(2, 1, 3), r(2, 1, 3);
  v.data = {2, 2, 2, 2, 2, 2};
  r.data = {1, 1, 1, 3, 3, 3};
  const auto value = [&](const char* metric) { return measure(metric, v, plain(r)).value; };
  EXPECT_NEAR(value("mse"), 1, 1e-12);
  EXPECT_NEAR(value("rmse"), 1, 1e-12);
  EXPECT_NEAR(value("mae"), 1, 1e-12);
  EXPECT_NEAR(value("relmse"), (1 / 1.0004 + 1 / 9.0004) / 2, 1e-9);
  EXPECT_NEAR(value("smape"), (2 / 3.02 + 2 / 5.02) / 2, 1e-9);
  EXPECT_NEAR(value("bias"), 0, 1e-12);
  EXPECT_NEAR(value("psnr"), 9.542425094393249, 1e-9);  // 20 log10(3)
  EXPECT_EQ(measure("psnr", v, plain(r)).peak, 3);
  EXPECT_NEAR(measure("relmse", v, plain(r)).epsilon, 0.02, 1e-9);
  // A twentieth of the light is missing.
  for (size_t i = 0; i < v.data.size(); ++i) v.data[i] = 0.95f * r.data[i];
  EXPECT_NEAR(value("bias"), -0.05, 1e-7);
}

TEST(Metrics, TermsAreTakenChannelByChannel) {
  Image v(1, 1, 3), r(1, 1, 3);
  v.data = {2, 1, 0};
  r.data = {1, 1, 1};
  EXPECT_NEAR(measure("mse", v, plain(r)).value, 2.0 / 3, 1e-12);
  EXPECT_NEAR(measure("relmse", v, plain(r), {}, false, 1.0).value, (0.5 + 0 + 0.5) / 3, 1e-12);
  EXPECT_NEAR(measure("bias", v, plain(r)).value, 0, 1e-12);
}

TEST(Metrics, AgreeWithOpenImageIo) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Image r = randomImage(67, 41, 3, seed), v = disturbed(r, seed + 100);
    r.pixel(5, 5)[1] = 500;  // OpenImageIO's peak is the largest value of both images: make it the reference's
    const OIIO::ImageBuf vb = bufferOf(v), rb = bufferOf(r);
    const auto theirs = OIIO::ImageBufAlgo::compare(vb, rb, 0.0f, 0.0f);
    const auto value = [&](const char* metric) { return measure(metric, v, plain(r)).value; };
    EXPECT_NEAR(value("mse") / (theirs.rms_error * theirs.rms_error), 1, 1e-4);
    EXPECT_NEAR(value("rmse") / theirs.rms_error, 1, 1e-4);
    EXPECT_NEAR(value("mae") / theirs.meanerror, 1, 1e-4);
    EXPECT_NEAR(value("psnr") / theirs.PSNR, 1, 1e-4);

    namespace Algo = OIIO::ImageBufAlgo;
    const auto e = static_cast<float>(0.01 * meanLuminance(r));
    const OIIO::ImageBuf difference = Algo::sub(vb, rb);
    const OIIO::ImageBuf relative = Algo::div(Algo::mul(difference, difference), Algo::add(Algo::mul(rb, rb), e * e));
    EXPECT_NEAR(value("relmse") / meanOf(relative), 1, 1e-4);
    const OIIO::ImageBuf symmetric =
        Algo::div(Algo::mul(Algo::abs(difference), 2.0f), Algo::add(Algo::add(Algo::abs(vb), Algo::abs(rb)), e));
    EXPECT_NEAR(value("smape") / meanOf(symmetric), 1, 1e-4);
    EXPECT_NEAR(value("bias") / (meanOf(difference) / meanOf(rb)), 1, 1e-4);
  }
}

class EachMetric : public testing::TestWithParam<MetricInfo> {
 protected:
  std::string id() const { return std::string(GetParam().id); }
  /// What follows from a pixel's own values alone.
  bool plainTerm() const { return !GetParam().windowed; }
};

TEST_P(EachMetric, IsZeroForAnImageAgainstItself) {
  const Image a = randomImage(40, 30, 3, 1);
  for (const Image& image : {a, Image(40, 30, 3)}) {  // a scene without light too
    const MetricResult result = measure(id(), image, plain(image));
    EXPECT_EQ(result.value, GetParam().perfect);
    EXPECT_EQ(result.standardError, 0);
    EXPECT_TRUE(std::isnan(result.noiseFloor));  // without halves nothing is known of the reference's noise
    EXPECT_EQ(result.pixels, 1200u);
    EXPECT_EQ(result.nonFinite, 0u);
  }
}

TEST_P(EachMetric, FailsOnAPixelThatIsNotFinite) {
  const Image r = randomImage(20, 20, 3, 1), v = disturbed(r, 2);
  for (float bad : {kNan, kInf, -kInf}) {
    Image broken = v;
    broken.pixel(3, 4)[2] = broken.pixel(3, 4)[0] = broken.pixel(7, 7)[1] = bad;
    const MetricResult inValue = measure(id(), broken, plain(r), {}, true);
    EXPECT_TRUE(std::isnan(inValue.value)) << inValue.value;
    EXPECT_TRUE(std::isnan(inValue.standardError));
    EXPECT_EQ(inValue.nonFinite, 2u);
    EXPECT_EQ(inValue.pixels, 400u);
    const MetricResult inReference = measure(id(), r, plain(broken));
    EXPECT_TRUE(std::isnan(inReference.value));
    EXPECT_EQ(inReference.nonFinite, 2u);
    const MetricResult inHalf = measure(id(), v, ReferenceImage{r, r, broken});
    EXPECT_TRUE(std::isnan(inHalf.value));
    EXPECT_EQ(inHalf.nonFinite, 2u);
    // Where the pixels do not count, neither does what they hold.
    Mask mask(400, 1);
    mask[4 * 20 + 3] = mask[7 * 20 + 7] = 0;
    const MetricResult masked = measure(id(), broken, plain(r), mask);
    EXPECT_EQ(masked.nonFinite, 0u);
    EXPECT_EQ(masked.pixels, 398u);
    EXPECT_TRUE(std::isfinite(masked.value));
    EXPECT_EQ(masked.value, measure(id(), v, plain(r), mask).value);
  }
}

TEST_P(EachMetric, OfARegionIsThatOfTheCroppedImages) {
  if (!plainTerm()) return;  // windows see past the region: tests/unit/metrics_picture_test.cpp
  const Image r = randomImage(50, 40, 3, 3), v = disturbed(r, 4);
  const PixelRectangle region{7, 11, 32, 16};
  Image croppedV(region.width, region.height, 3), croppedR = croppedV;
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x)
      for (int c = 0; c < 3; ++c) {
        croppedV.pixel(x, y)[c] = v.pixel(x + region.x, y + region.y)[c];
        croppedR.pixel(x, y)[c] = r.pixel(x + region.x, y + region.y)[c];
      }
  const MetricResult whole = measure(id(), v, plain(r), rectangleMask(50, 40, region));
  const MetricResult cropped = measure(id(), croppedV, plain(croppedR));
  EXPECT_NEAR(whole.value, cropped.value, 1e-12 * std::fabs(cropped.value));
  EXPECT_EQ(whole.pixels, 32u * 16);
  EXPECT_NE(whole.value, measure(id(), v, plain(r)).value);
}

TEST_P(EachMetric, IgnoresChannelsPastTheThird) {
  Image r = randomImage(20, 20, 4, 5), v = disturbed(r, 6), rgbR(20, 20, 3), rgbV(20, 20, 3);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      for (int c = 0; c < 3; ++c) rgbR.pixel(x, y)[c] = r.pixel(x, y)[c], rgbV.pixel(x, y)[c] = v.pixel(x, y)[c];
      v.pixel(x, y)[3] = kNan;
    }
  EXPECT_EQ(measure(id(), v, plain(r)).value, measure(id(), rgbV, plain(rgbR)).value);
  EXPECT_EQ(measure(id(), v, plain(rgbR)).value, measure(id(), rgbV, plain(rgbR)).value);
}

TEST_P(EachMetric, MapsWhatItMeasures) {
  const Image r = randomImage(30, 20, 3, 7), v = disturbed(r, 8);
  Mask mask(600, 1);
  for (size_t i = 0; i < 200; ++i) mask[i * 3] = 0;
  EXPECT_TRUE(measure(id(), v, plain(r), mask).map.data.empty());
  const Image map = measure(id(), v, plain(r), mask, true).map;
  ASSERT_EQ(map.data.size(), 600u);
  ASSERT_EQ(map.channels, 1);
  double sum = 0;
  for (size_t i = 0; i < 600; ++i) {
    if (mask[i] == 0) {
      EXPECT_EQ(map.data[i], 0);
    }
    sum += id() == "rmse" ? static_cast<double>(map.data[i]) * map.data[i] : map.data[i];
  }
  const bool ofSquares = id() == "rmse" || id() == "psnr";
  const double expected = measure(ofSquares ? "mse" : id(), v, plain(r), mask).value;
  EXPECT_NEAR(sum / 400, expected, 1e-6 * std::fabs(expected));
}

TEST_P(EachMetric, WeighsByArea) {
  if (!plainTerm()) return;  // copies of a pixel have other neighbours: tests/unit/metrics_picture_test.cpp
  const Image r = randomImage(16, 16, 3, 9), v = disturbed(r, 10);
  // A pixel of weight 3 counts like three pixels.
  Image longR(32, 16, 3), longV(32, 16, 3);
  MeasureOptions options;
  options.weights.assign(256, 1.0f);
  Mask counted(512, 0);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const bool twice = (x + y) % 3 == 0;
      if (twice) options.weights[static_cast<size_t>(y * 16 + x)] = 2;
      for (int copy = 0; copy < 2; ++copy) {
        counted[static_cast<size_t>(y * 32 + x + 16 * copy)] = copy == 0 || twice;
        for (int c = 0; c < 3; ++c) {
          longR.pixel(x + 16 * copy, y)[c] = r.pixel(x, y)[c];
          longV.pixel(x + 16 * copy, y)[c] = v.pixel(x, y)[c];
        }
      }
    }
  const double weighted = measure(id(), v, plain(r), options).value;
  EXPECT_NEAR(weighted, measure(id(), longV, plain(longR), counted).value, 1e-12 * std::fabs(weighted));
  options.weights.assign(256, 0.25f);
  const double plainValue = measure(id(), v, plain(r)).value;
  EXPECT_NEAR(measure(id(), v, plain(r), options).value, plainValue, 1e-12 * std::fabs(plainValue));
}

TEST_P(EachMetric, FollowsTheScaleOfTheLight) {
  Image r = randomImage(20, 20, 3, 11), v = disturbed(r, 12);
  const double before = measure(id(), v, plain(r)).value;
  for (float& x : r.data) x *= 1024;
  for (float& x : v.data) x *= 1024;
  const double after = measure(id(), v, plain(r)).value;
  const bool shown = id() == "ssim" || id() == "flip" || id() == "l_star_mse";
  if (shown) {
    EXPECT_NE(before, after);
  } else {
    const double factor = id() == "mse" ? 1024.0 * 1024 : id() == "rmse" || id() == "mae" || id() == "dfpr" ? 1024 : 1;
    EXPECT_NEAR(after, factor * before, 1e-9 * std::fabs(factor * before));
  }
  // What is measured on the picture, or after the exposure, is the same again where the exposure makes up for it.
  if (!shown && id() != "dfpr") return;
  MeasureOptions options;
  options.appearance.exposure = -10;
  EXPECT_NEAR(measure(id(), v, plain(r), options).value, before, 1e-9 * std::fabs(before));
}

INSTANTIATE_TEST_SUITE_P(Metrics, EachMetric, testing::ValuesIn(metricInfos().begin(), metricInfos().end()),
                         [](const auto& named) { return std::string(named.param.id); });

TEST(Metrics, AreThoseThatWereAskedFor) {
  std::string ids;
  for (const MetricInfo& info : metricInfos()) {
    ids += std::string(info.id) + " ";
    EXPECT_FALSE(info.label.empty());
    EXPECT_FALSE(info.formula.empty());
  }
  EXPECT_EQ(ids, "mse rmse mae relmse smape bias psnr ssim flip flip_hdr l_star_mse dfpr ");
}

TEST(Metrics, AnErrorAgainstNothingIsInfiniteNotHidden) {
  Image v(4, 4, 3);
  v.data[0] = 1;
  EXPECT_EQ(measure("relmse", v, plain(Image(4, 4, 3))).value, std::numeric_limits<double>::infinity());
  EXPECT_EQ(measure("mse", v, plain(Image(4, 4, 3))).value, 1.0 / 48);
  EXPECT_EQ(measure("psnr", v, plain(Image(4, 4, 3))).peak, 1);
}

TEST(Metrics, BadInputIsNamed) {
  const Image a(4, 3, 3);
  EXPECT_NE(messageOf([&] { measure("relmes", a, plain(a)); }).find("'relmse'"), std::string::npos);
  EXPECT_NE(messageOf([&] { measure("sparkle", a, plain(a)); }).find("psnr"), std::string::npos);
  EXPECT_NE(messageOf([&] { measure("mse", a, plain(Image(3, 4, 3))); }).find("4 x 3"), std::string::npos);
  messageOf([&] { measure("mse", a, plain(Image(4, 3, 1))); });
  messageOf([&] { measure("mse", a, plain(a), Mask(11, 1)); });
  EXPECT_NE(messageOf([&] { measure("mse", a, plain(a), Mask(12, 0)); }).find("no pixel counts"), std::string::npos);
  messageOf([&] { measure("mse", Image(), plain(Image())); });
  messageOf([&] { measure("mse", a, ReferenceImage{a, a, {}}); });
  messageOf([&] { measure("mse", a, ReferenceImage{a, a, Image(2, 2, 3)}); });
  MeasureOptions options;
  for (float bad : {-1.0f, kNan, kInf}) {
    options.weights.assign(12, bad);
    messageOf([&] { measure("mse", a, plain(a), options); });
  }
}

TEST(RectangleMask, StaysInsideTheImageAndItsBase) {
  Mask base(12, 1);
  base[5] = 0;
  EXPECT_EQ(rectangleMask(4, 3, {1, 1, 2, 2}, base), (Mask{0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0}));
  constexpr int kMost = std::numeric_limits<int>::max();
  for (const PixelRectangle& bad : {PixelRectangle{0, 0, 5, 1},
                                    {0, 0, 1, 4},
                                    {-1, 0, 2, 2},
                                    {0, 0, 0, 1},
                                    {3, 2, 2, 1},
                                    {kMost, 0, kMost, 1},
                                    {1, 1, kMost, kMost}})
    messageOf([&] { rectangleMask(4, 3, bad); });
}

}  // namespace
}  // namespace hl
