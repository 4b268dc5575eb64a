// Composite and tone map, on the device and on the host, against the formulas written out here.
#include "engine/passes/display.h"

#include <cmath>
#include <limits>

#include "engine/passes/error_colours.h"
#include "tests/gpu_fixture.h"

namespace hl {
namespace {

constexpr int kWidth = 17, kHeight = 11;
const float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

class DisplayTest : public test::GpuTest {
 protected:
  GpuImage image(const char* name, const std::vector<float>& data, Format format = Format::RGBA32F) {
    const GpuImage i = device->image(name, {kWidth, kHeight, format});
    device->upload(i, 0, data.data(), data.size() * 4);
    return i;
  }
  static std::vector<float> filled(const std::function<float(size_t pixel, size_t channel)>& f) {
    std::vector<float> data(static_cast<size_t>(kWidth * kHeight * 4));
    for (size_t i = 0; i < data.size(); ++i) data[i] = f(i / 4, i % 4);
    return data;
  }
  std::vector<unsigned char> bytes(const GpuImage& i) {
    std::vector<unsigned char> out(static_cast<size_t>(i.width()) * static_cast<size_t>(i.height()) * 4);
    device->download(i, out.data(), out.size());
    return out;
  }
  static Image asImage(const std::vector<float>& rgba) {
    Image i(kWidth, kHeight, 4);
    i.data = rgba;
    return i;
  }
};

TEST_F(DisplayTest, CompositeAddsUp) {
  const auto wave = [](float a, float b) {
    return filled(
        [=](size_t p, size_t c) { return a + b * std::sin(static_cast<float>(p) + 2 * static_cast<float>(c)); });
  };
  auto place = wave(0, 1);
  for (size_t p = 0; p < place.size() / 4; ++p) place[4 * p + 3] = p % 3 == 0 ? 0.0f : p % 3 == 1 ? 1.0f : -1.0f;
  const auto albedo = wave(0.5f, 0.3f), emission = wave(2, 1), direct = wave(10, 3), indirect = wave(4, 2);
  GBuffer g;
  g.width = kWidth, g.height = kHeight;
  g.position = image("position", place), g.albedo = image("albedo", albedo), g.emission = image("emission", emission);
  const GpuImage e = image("direct", direct), i = image("indirect", indirect);
  const vec3 sky(0.1f, 0.2f, 0.3f);
  const GpuImage both = recordComposite(*graph, g, e, i, sky), one = recordComposite(*graph, g, e, GpuImage(), sky);
  const GpuImage alone = recordComposite(*graph, g, GpuImage(), i, sky);
  EXPECT_EQ(both.state(), one.state()) << "a transient of one name";
  graph->drop();
  const auto lobes = wave(3, 2);
  const GpuImage l = image("lobes", lobes);
  const auto run = [&](const GpuImage& a, const GpuImage& b, const GpuImage& s = {}) {
    const GpuImage out = recordComposite(*graph, g, a, b, sky, s);
    graph->execute();
    return device->download(out).data;
  };
  const auto all = run(e, i), directOnly = run(e, GpuImage()), indirectOnly = run(GpuImage(), i),
             none = run(GpuImage(), GpuImage()), withLobes = run(e, i, l), lobesOnly = run(GpuImage(), GpuImage(), l);
  for (size_t p = 0; p < place.size() / 4; ++p) {
    const bool surface = place[4 * p + 3] != 0;
    for (size_t c = 0; c < 3; ++c) {
      const size_t k = 4 * p + c;
      const float rest = surface ? emission[k] : sky[static_cast<int>(c)], f = surface ? albedo[k] / kPi : 0;
      ASSERT_NEAR(all[k], rest + (direct[k] + indirect[k]) * f, 1e-5f);
      ASSERT_NEAR(directOnly[k], rest + direct[k] * f, 1e-5f);
      ASSERT_NEAR(indirectOnly[k], indirect[k] * f, 1e-5f);
      ASSERT_EQ(none[k], 0);
      ASSERT_NEAR(withLobes[k], rest + (direct[k] + indirect[k]) * f + (surface ? lobes[k] : 0), 1e-5f);
      ASSERT_EQ(lobesOnly[k], surface ? lobes[k] : 0);
    }
  }
}

TEST_F(DisplayTest, DeviceAndHostMapAlike) {
  const auto data = filled([](size_t p, size_t c) {
    return std::pow(1.08f, static_cast<float>(p)) * 1e-3f * (1 + 0.3f * static_cast<float>(c));
  });
  const GpuImage source = image("source", data);
  const Buffer counters = device->buffer("counters", 8);
  for (const ToneMap curve : {ToneMap::Linear, ToneMap::Aces, ToneMap::Reinhard}) {
    for (const float exposure : {0.0f, -2.5f, 3.0f}) {
      Display d;
      d.toneMap = curve, d.exposure = exposure;
      const GpuImage out = recordToneMap(*graph, source, d, true, kWidth, kHeight, counters);
      graph->execute();
      const auto shown = bytes(out), host = toneMapOnHost(asImage(data), d);
      for (size_t p = 0; p < data.size() / 4; ++p) {
        for (size_t c = 0; c < 3; ++c) {
          // The formulas, once more and in double precision.
          double x = data[4 * p + c] * std::exp2(static_cast<double>(exposure));
          if (curve == ToneMap::Reinhard) x = x / (1 + x);
          if (curve == ToneMap::Aces) x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
          x = std::min(x, 1.0);
          x = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
          ASSERT_NEAR(host[4 * p + c], 255 * x, 0.51);
          ASSERT_NEAR(shown[4 * p + c], 255 * x, 0.76) << "half a code and what the device's pow may be off";
        }
        ASSERT_EQ(shown[4 * p + 3], 255);
        ASSERT_EQ(host[4 * p + 3], 255);
      }
      EXPECT_EQ(download<uint32_t>(counters), (std::vector<uint32_t>{0, 0}));
    }
  }
}

TEST_F(DisplayTest, CountsAndShowsWhatIsWrong) {
  auto data = filled([](size_t, size_t) { return 0.5f; });
  data[4 * 3] = kNan;
  data[4 * 20 + 1] = -kNan;
  data[4 * 40 + 2] = kInf;
  data[4 * 50] = -kInf;
  data[4 * 60 + 1] = -0.25f;
  data[4 * 61] = -1e-30f;
  data[4 * 62] = -1, data[4 * 62 + 1] = kNan;  // counted as not finite alone
  data[4 * 70 + 3] = kNan;                     // no colour
  const GpuImage source = image("source", data);
  const Buffer counters = device->buffer("counters", 8);
  Display d;
  for (const bool loud : {false, true}) {
    d.showInvalid = loud;
    const GpuImage out = recordToneMap(*graph, source, d, true, kWidth, kHeight, counters);
    graph->execute();
    EXPECT_EQ(download<uint32_t>(counters), (std::vector<uint32_t>{5, 2}));
    const auto shown = bytes(out), host = toneMapOnHost(asImage(data), d);
    using Rgb = std::array<unsigned char, 3>;
    const auto at = [](const std::vector<unsigned char>& v, size_t p) {
      return Rgb{v[4 * p], v[4 * p + 1], v[4 * p + 2]};
    };
    for (const size_t p : {3u, 20u, 40u, 50u, 60u, 61u, 62u}) EXPECT_EQ(at(shown, p), at(host, p)) << p;
    if (loud) {
      for (const size_t p : {3u, 20u, 62u}) EXPECT_EQ(at(shown, p), (Rgb{255, 0, 255}));
      for (const size_t p : {40u, 50u}) EXPECT_EQ(at(shown, p), (Rgb{255, 255, 0}));
      for (const size_t p : {60u, 61u}) EXPECT_EQ(at(shown, p), (Rgb{0, 255, 255}));
    } else {
      EXPECT_EQ(at(shown, 40), (Rgb{0, 0, 255}));
      EXPECT_EQ(at(shown, 50), (Rgb{0, 0, 0}));
      EXPECT_EQ(at(shown, 60), (Rgb{188, 0, 188}));
    }
    EXPECT_EQ(at(shown, 0), (Rgb{188, 188, 188}));
  }
}

TEST_F(DisplayTest, ShowsImagesOfOtherKindsAndSizes) {
  const Buffer counters = device->buffer("counters", 8);
  Display d;
  d.exposure = 5;  // concerns radiance alone
  // One channel is grey, and 2x1 texels are stretched over the frame.
  const GpuImage two = device->image("two", {2, 1, Format::R32F});
  const float values[] = {1, 0};
  device->upload(two, 0, values, sizeof values);
  auto shown = bytes(recordToneMap(*graph, two, d, false, 8, 4, counters));
  graph->execute();
  shown = bytes(graph->transient("display", {8, 4, Format::RGBA8}));
  for (size_t p = 0; p < 32; ++p) {
    for (size_t c = 0; c < 3; ++c) ASSERT_EQ(shown[4 * p + c], p % 8 < 4 ? 255 : 0);
  }
  // Directions from [-1, 1]; no surface stays black.
  auto data = filled([](size_t p, size_t c) {
    return p == 0 || c == 3 ? 0.0f : c == 0 ? 1.0f : c == 1 ? -1.0f : 0.0f;
  });
  d.view = "normal";
  GpuImage out = recordToneMap(*graph, image("normals", data), d, false, kWidth, kHeight, counters);
  graph->execute();
  shown = bytes(out);
  EXPECT_EQ(shown[0], 0);
  EXPECT_EQ(shown[4], 255);
  EXPECT_EQ(shown[5], 0);
  EXPECT_NEAR(shown[6], 127.5, 0.51);
  EXPECT_EQ(download<uint32_t>(counters), (std::vector<uint32_t>{0, 0})) << "a negative direction is no fault";
  // No image is black.
  out = recordToneMap(*graph, GpuImage(), d, true, kWidth, kHeight, counters);
  graph->execute();
  EXPECT_EQ(bytes(out)[0], 0);
  const GpuImage labels = device->image("labels", {4, 4, Format::R32U});
  EXPECT_EQ(test::errorOf([&] { recordToneMap(*graph, labels, d, true, 4, 4, counters); }).kind(), ErrorKind::BadInput);
}

TEST(FalseColour, RunsFromDarkVioletToYellow) {
  Image map(5, 1, 1);
  map.data = {0, 0.5f, 1, 99, kNan};
  const auto out = falseColour(map, 1);
  const std::vector<unsigned char> ends = {0x44, 0x01, 0x54, 255}, top = {0xfd, 0xe7, 0x25, 255},
                                   bad = {255, 0, 255, 255};
  EXPECT_TRUE(std::equal(ends.begin(), ends.end(), out.begin()));
  EXPECT_TRUE(std::equal(top.begin(), top.end(), out.begin() + 8));
  EXPECT_TRUE(std::equal(top.begin(), top.end(), out.begin() + 12));
  EXPECT_TRUE(std::equal(bad.begin(), bad.end(), out.begin() + 16));
  EXPECT_EQ(test::errorOf([&] { falseColour(map, 0); }).kind(), ErrorKind::BadInput);
  // Brightness only rises.
  Image ramp(256, 1, 1);
  for (size_t i = 0; i < 256; ++i) ramp.data[i] = static_cast<float>(i) / 255;
  const auto colours = falseColour(ramp, 1);
  double last = -1;
  for (size_t i = 0; i < 256; ++i) {
    const double y = 0.2126 * colours[4 * i] + 0.7152 * colours[4 * i + 1] + 0.0722 * colours[4 * i + 2];
    EXPECT_GE(y, last - 0.8);
    last = y;
  }
}

/// Each metric has its colours: an end of its own where it has one, a colour a sign, and the quantile elsewhere.
TEST(ErrorColours, FollowTheMetric) {
  Image map(200, 1, 1);
  for (size_t i = 0; i < 200; ++i) map.data[i] = static_cast<float>(i) / 199;
  const auto colour = [](const std::vector<unsigned char>& out, size_t i) { return std::vector<unsigned char>(out.begin() + 4 * i, out.begin() + 4 * i + 3); };
  const std::vector<unsigned char> black = {0, 0, 4}, brightest = {0xfc, 0xfd, 0xbf}, yellow = {0xfd, 0xe7, 0x25}, magenta = {255, 0, 255};
  const auto flip = errorColours(map, metricInfo("flip")), ssim = errorColours(map, metricInfo("ssim"));
  EXPECT_EQ(colour(flip, 0), black);
  EXPECT_EQ(colour(flip, 199), brightest);
  EXPECT_EQ(colour(ssim, 0), brightest) << "a similarity of 0 is the worst";
  EXPECT_EQ(colour(ssim, 199), black);
  for (float& v : map.data) v *= 1e-3f;
  EXPECT_NE(colour(errorColours(map, metricInfo("flip")), 199), brightest) << "its scale is fixed";
  EXPECT_EQ(colour(errorColours(map, metricInfo("relmse")), 199), yellow) << "its scale is the map's";
  map.data[0] = -1e-3f, map.data[1] = 1e-3f, map.data[2] = 0, map.data[3] = kNan;
  const auto bias = errorColours(map, metricInfo("bias"));
  EXPECT_GT(colour(bias, 0)[2], colour(bias, 0)[0] + 80) << "below: blue";
  EXPECT_GT(colour(bias, 1)[0], colour(bias, 1)[2] + 80) << "above: orange";
  EXPECT_EQ(colour(bias, 2)[0], colour(bias, 2)[2]);
  EXPECT_EQ(colour(bias, 3), magenta);
}

TEST(SignedColour, IsBlueBelowOrangeAboveAndEquallyDarkAtBothEnds) {
  Image ramp(129, 1, 1);
  for (size_t i = 0; i < 129; ++i) ramp.data[i] = (static_cast<float>(i) - 64) / 32;  // -2 to 2
  const auto c = falseColour(ramp, 2, ColourScale::Signed);
  const auto luminance = [&](size_t i) { return (0.2126 * c[4 * i] + 0.7152 * c[4 * i + 1] + 0.0722 * c[4 * i + 2]) / 255; };
  EXPECT_EQ(c[4 * 64], c[4 * 64 + 2]);
  for (size_t i = 1; i <= 64; ++i) {
    EXPECT_GT(c[4 * (64 - i) + 2], c[4 * (64 - i)]) << i;  // blue
    EXPECT_LT(c[4 * (64 + i) + 2], c[4 * (64 + i)]) << i;  // orange
    EXPECT_NEAR(luminance(64 - i), luminance(64 + i), 0.03) << i;
    EXPECT_LE(luminance(64 + i), luminance(63 + i) + 0.004) << i;
    EXPECT_LE(luminance(64 - i), luminance(65 - i) + 0.004) << i;
  }
  Image beyond(3, 1, 3);
  beyond.data = {99, 99, 99, -99, -99, -99, kNan, 0, 0};
  const auto ends = falseColour(beyond, 1, ColourScale::Signed);
  EXPECT_TRUE(std::equal(ends.begin(), ends.begin() + 4, c.begin() + 4 * 128));
  EXPECT_TRUE(std::equal(ends.begin() + 4, ends.begin() + 8, c.begin()));
  EXPECT_EQ(ends[8], 255);
  EXPECT_EQ(ends[9], 0);
  EXPECT_EQ(test::errorOf([&] { falseColour(beyond, 0, ColourScale::Signed); }).kind(), ErrorKind::BadInput);
  EXPECT_EQ(colourScale(beyond), 99);
}

TEST(DisplayViews, HaveIdsOfTheirOwn) {
  std::vector<std::string> ids;
  for (const ViewInfo& v : displayViews()) {
    EXPECT_EQ(std::count(ids.begin(), ids.end(), v.id), 0);
    ids.push_back(v.id);
  }
  EXPECT_EQ(ids.front(), Display().view);
}

}  // namespace
}  // namespace hl
