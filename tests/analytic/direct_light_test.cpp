// Direct irradiance at points, through every tracer, against closed forms. Where light is sampled, many copies of a
// point (each with a random sequence of its own) give a mean and its standard error.
#include "engine/passes/direct_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "shaders/shared/surface_point.h"
#include "tests/environment_maps.h"
#include "tests/trace_scenes.h"

namespace hl {
namespace {

using shared::SurfacePoint;

constexpr double kPiD = 3.14159265358979323846;

SurfacePoint receiver(vec3 position, vec3 normal, vec3 geometricNormal, float offset) {
  return {position, offset, glm::normalize(normal), 0, glm::normalize(geometricNormal), 0};
}
SurfacePoint receiver(vec3 position, vec3 normal, float offset = 1e-5f) {
  return receiver(position, normal, normal, offset);
}

struct Estimate {
  double mean = 0, error = 0;  ///< of the red channel; error: standard error of the mean
  vec3 rgb{0.0f};
};

class DirectLightTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    device = std::make_unique<Device>(DeviceOptions{"", true}), shaders = std::make_unique<ShaderLibrary>(*device);
  }
  void TearDown() override {
    light.reset();
    for (const std::string& message : device->takeValidationMessages()) ADD_FAILURE() << message;
  }

  void use(Scene s) {
    light.reset(), tracer.reset();
    scene = std::move(s);
    gpuScene = uploadScene(*device, scene);
    tracer = makeTracer(GetParam(), *device, *shaders, scene, gpuScene, nullptr, pool);
    light = std::make_unique<DirectLight>(*device, *shaders, gpuScene, *tracer);
  }

  /// Sum over samples of what every point receives; w counts them.
  std::vector<vec4> irradiance(const std::vector<SurfacePoint>& points, uint32_t samples, uint32_t seed = 1) {
    const auto count = static_cast<uint32_t>(points.size());
    const Buffer in = device->buffer("points", std::span<const SurfacePoint>(points));
    const Buffer out = device->buffer("irradiance", count * sizeof(vec4));
    FrameGraph graph(*device, *shaders);
    graph.clear("clear", out);
    for (uint32_t s = 0; s < samples; ++s) light->record(graph, "direct", in, out, 0, count, seed, s);
    graph.execute();
    std::vector<vec4> sums(count);
    device->download(out, sums.data(), count * sizeof(vec4));
    return sums;
  }

  Estimate estimate(const SurfacePoint& point, uint32_t copies, uint32_t samples) {
    const std::vector<vec4> sums = irradiance(std::vector<SurfacePoint>(copies, point), samples);
    Estimate e;
    double sum = 0, squares = 0;
    for (const vec4& s : sums) {
      EXPECT_EQ(s.w, static_cast<float>(samples));
      const double mean = static_cast<double>(s.x) / static_cast<double>(s.w);
      sum += mean, squares += mean * mean;
      e.rgb += vec3(s.x, s.y, s.z) / s.w;
    }
    e.mean = sum / copies;
    e.error = std::sqrt(std::max(0.0, squares / copies - e.mean * e.mean) / (copies - 1));
    e.rgb /= static_cast<float>(copies);
    return e;
  }

  /// Within 3 standard errors of at most 0.2 % (rounding aside).
  void expectIrradiance(const char* what, const Estimate& e, double expected) {
    const double relative = e.error / expected;
    printf("  %-6s %-34s %.7f, expected %.7f, off by %+.4f %% (standard error %.4f %%)\n", GetParam(), what, e.mean,
           expected, 100 * (e.mean / expected - 1), 100 * relative);
    EXPECT_LE(relative, 0.002) << what;
    EXPECT_NEAR(e.mean, expected, 3 * e.error + 3e-6 * expected) << what;
  }

  std::unique_ptr<Device> device;
  std::unique_ptr<ShaderLibrary> shaders;
  TaskPool pool;
  Scene scene;
  GpuScene gpuScene;
  std::unique_ptr<Tracer> tracer;
  std::unique_ptr<DirectLight> light;
};

INSTANTIATE_TEST_SUITE_P(Tracers, DirectLightTest, ::testing::Values("embree", "bvh"),
                         [](const auto& p) { return std::string(p.param); });

/// A unit square that shines downwards from height 1, centred over the origin.
Scene square(vec3 radiance = vec3(2, 1, 0.5f)) {
  Scene s;
  test::addQuad(s, vec3(-0.5f, 1, -0.5f), vec3(1, 0, 0), vec3(0, 0, 1), test::addMaterial(s, radiance));
  return s;
}
constexpr double kCentredSquare = 0.2394564705;

TEST_P(DirectLightTest, PointUnderACentredSquare) {
  use(square());
  const Estimate e = estimate(receiver(vec3(0.0f), {0, 1, 0}), 4096, 16);
  expectIrradiance("unit square at distance 1", e, kCentredSquare * kPiD * 2);
  EXPECT_NEAR(e.rgb.y / e.rgb.x, 0.5f, 1e-5f);
  EXPECT_NEAR(e.rgb.z / e.rgb.x, 0.25f, 1e-5f);
}

TEST_P(DirectLightTest, EmittersAreOneSidedAndReceiversToo) {
  use(square());
  EXPECT_EQ(estimate(receiver({0, 2, 0}, {0, -1, 0}), 64, 4).mean, 0);
  EXPECT_EQ(estimate(receiver(vec3(0.0f), {0, -1, 0}), 64, 4).mean, 0);
}

TEST_P(DirectLightTest, QuarterBlockerTakesAQuarter) {
  // Half-way, over one quadrant of the square as the point sees it.
  Scene s = square(vec3(1.0f));
  test::addQuad(s, vec3(0, 0.5f, 0), vec3(0, 0, 0.5f), vec3(0.5f, 0, 0), test::addMaterial(s));
  use(std::move(s));
  expectIrradiance("with a quadrant blocked", estimate(receiver(vec3(0.0f), {0, 1, 0}), 4096, 16),
                   0.75 * kCentredSquare * kPiD);
}

TEST_P(DirectLightTest, QuarterBlockerBetweenUnitSquares) {
  // Mean over the lower square: 3/4 of the form factor between parallel unit squares at distance 1.
  Scene s = square(vec3(1.0f));
  test::addQuad(s, vec3(0, 0.5f, 0), vec3(0, 0, 0.5f), vec3(0.5f, 0, 0), test::addMaterial(s));
  use(std::move(s));
  std::vector<SurfacePoint> points;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x)
      points.push_back(receiver(
          {(static_cast<float>(x) + 0.5f) / 96 - 0.5f, 0, (static_cast<float>(y) + 0.5f) / 96 - 0.5f}, {0, 1, 0}));
  double sum = 0;
  for (const vec4& v : irradiance(points, 16)) sum += static_cast<double>(v.x) / static_cast<double>(v.w);
  const double mean = sum / static_cast<double>(points.size()), expected = 0.1498686718 * kPiD;
  printf("  %-6s between unit squares: %.6f, expected %.6f (%+.4f %%)\n", GetParam(), mean, expected,
         100 * (mean / expected - 1));
  EXPECT_NEAR(mean, expected, 0.001 * expected);
}

TEST_P(DirectLightTest, ElementBesideTheCornerOfAPerpendicularSquare) {
  Scene s;
  test::addQuad(s, vec3(0.0f), vec3(0, 1, 0), vec3(0, 0, 1), test::addMaterial(s, vec3(1.0f)));  // shines towards +x
  use(std::move(s));
  for (const double c : {1.0, 0.1, 0.01, 0.001}) {
    const double reach = std::sqrt(1 + c * c);
    const double formFactor = (std::atan(1 / c) - c / reach * std::atan(1 / reach)) / (2 * kPiD);
    const std::string what = "corner at distance " + std::to_string(c);
    expectIrradiance(what.c_str(), estimate(receiver({static_cast<float>(c), 0, 0}, {0, 0, 1}, 1e-6f), 4096, 16),
                     formFactor * kPiD);
  }
}

TEST_P(DirectLightTest, PointLightFallsWithSquareAndCosine) {
  for (const float distance : {0.5f, 1.0f, 3.0f}) {
    for (const float angle : {0.0f, 0.6f, 1.2f}) {
      Scene s;
      s.pointLights.push_back({"lamp", vec3(0, distance, 0), vec3(7, 14, 21)});
      use(std::move(s));
      const Estimate e = estimate(receiver(vec3(0.0f), {std::sin(angle), std::cos(angle), 0}), 4, 1);
      const double expected =
          7 * std::cos(static_cast<double>(angle)) / (static_cast<double>(distance) * static_cast<double>(distance));
      EXPECT_NEAR(e.mean, expected, 2e-6 * expected);
      EXPECT_NEAR(e.rgb.z / e.rgb.x, 3, 1e-5f);
      EXPECT_TRUE(light->exactAfterOneSample());
    }
  }
}

TEST_P(DirectLightTest, SpotLightFallsOffBetweenItsCones) {
  const float inner = 0.3f, outer = 0.6f;
  for (const float angle : {0.0f, 0.29f, 0.4f, 0.5f, 0.59f, 0.61f, 1.0f, 2.5f}) {
    Scene s;
    s.spotLights.push_back(
        {"spot", vec3(0, 2, 0), glm::normalize(vec3(std::sin(angle), -std::cos(angle), 0)), vec3(8.0f), inner, outer});
    use(std::move(s));
    const double x = std::clamp((std::cos(static_cast<double>(angle)) - std::cos(static_cast<double>(outer))) /
                                    (std::cos(static_cast<double>(inner)) - std::cos(static_cast<double>(outer))),
                                0.0, 1.0);
    EXPECT_NEAR(estimate(receiver(vec3(0.0f), {0, 1, 0}), 4, 1).mean, 8.0 / 4 * x * x * (3 - 2 * x), 2e-5)
        << "at " << angle;
  }
}

TEST_P(DirectLightTest, DirectionalLightByCosine) {
  Scene s;
  s.directionalLights.push_back({"sun", glm::normalize(vec3(1, -1, 0)), vec3(3.0f)});
  test::addQuad(s, vec3(-3, 1, -1), vec3(0, 0, 2), vec3(2, 0, 0),
                test::addMaterial(s));  // shades x in [-2, 0] at y = 0
  use(std::move(s));
  EXPECT_NEAR(estimate(receiver({1, 0, 0}, {0, 1, 0}), 4, 1).mean, 3 / std::sqrt(2.0), 1e-5);
  EXPECT_EQ(estimate(receiver({-1, 0, 0}, {0, 1, 0}), 4, 1).mean, 0);
  EXPECT_EQ(estimate(receiver({1, 0, 0}, {1, 0, 0}), 4, 1).mean, 0);
}

TEST_P(DirectLightTest, PunctualLightsAreShadowedAndAddUp) {
  Scene s;
  s.pointLights.push_back({"left", vec3(-1, 1, 0), vec3(1.0f)});
  s.pointLights.push_back({"right", vec3(1, 1, 0), vec3(1.0f)});
  test::addQuad(s, vec3(-0.75f, 0.5f, -0.25f), vec3(0, 0, 0.5f), vec3(0.5f, 0, 0),
                test::addMaterial(s));  // before the left one
  use(std::move(s));
  const double each = 1 / 2.0 / std::sqrt(2.0);
  EXPECT_NEAR(estimate(receiver(vec3(0.0f), {0, 1, 0}), 4, 2).mean, each, 1e-6);
  EXPECT_NEAR(estimate(receiver({0, 0.75f, 0}, {0, 1, 0}), 4, 2).mean, 2 * 0.25 / std::pow(1.0625, 1.5), 1e-6);
}

TEST_P(DirectLightTest, SkyOverATiltedReceiver) {
  // A receiver on a large ground sees the upper half of the sky: pi (1 + cos t) / 2.
  Scene s;
  s.sky = vec3(1, 2, 3);
  test::addQuad(s, vec3(-1e4f, 0, -1e4f), vec3(0, 0, 2e4f), vec3(2e4f, 0, 0), test::addMaterial(s));
  use(s);
  for (const float t : {0.0f, 0.5f, 1.0f, 1.5f, 2.0f}) {
    const std::string what = "sky above ground, tilted by " + std::to_string(t);
    const double expected = kPiD * (1 + std::cos(static_cast<double>(t))) / 2;
    expectIrradiance(what.c_str(), estimate(receiver({0, 0.01f, 0}, {std::sin(t), std::cos(t), 0}), 4096, 32),
                     expected);
  }
  // The same from a mapped normal, whose light from below the surface's own horizon is turned away, with nothing there
  // to block it.
  Scene empty;
  empty.sky = s.sky;
  use(std::move(empty));
  for (const float t : {0.0f, 0.5f, 1.0f}) {
    const std::string what = "mapped normal, tilted by " + std::to_string(t);
    const double expected = kPiD * (1 + std::cos(static_cast<double>(t))) / 2;
    expectIrradiance(what.c_str(),
                     estimate(receiver(vec3(0.0f), {std::sin(t), std::cos(t), 0}, {0, 1, 0}, 1e-5f), 4096, 32),
                     expected);
  }
}

TEST_P(DirectLightTest, EnvironmentMaps) {
  // Half a sky, and a constant one as if it were the sky's own colour.
  Scene half;
  half.environment = test::mapOf(8, 4, [](int, int y) { return vec3(y < 2 ? 1.0f : 0.0f); });
  use(half);
  for (const float t : {0.0f, 0.7f, 1.5f}) {
    const double expected = kPiD * (1 + std::cos(static_cast<double>(t))) / 2;
    expectIrradiance(("half a sky, tilted by " + std::to_string(t)).c_str(), estimate(receiver(vec3(0.0f), {std::sin(t), std::cos(t), 0}), 4096, 64), expected);
  }
  Scene constant;
  constant.environment = test::mapOf(16, 8, [](int, int) { return vec3(1, 2, 3); });
  use(constant);
  const Estimate even = estimate(receiver(vec3(0.0f), {0.6f, 0.8f, 0}), 2048, 64);
  expectIrradiance("a constant map", even, kPiD);
  EXPECT_NEAR(even.rgb.z / even.rgb.x, 3, 1e-4f);

  // One bright texel: a directional light, wherever it is turned; and gone behind a wall.
  constexpr int kWidth = 256, kHeight = 128, kRow = 30;
  for (const float turn : {0.0f, 1.0f, -2.5f}) {
    Scene s;
    s.environment = test::mapOf(kWidth, kHeight, [](int x, int y) { return vec3(x == 200 && y == kRow ? 1e4f : 0.0f); });
    s.environment.rotation = turn;
    use(s);
    const vec3 towards = shared::environmentDirection(gpuScene.environment, 200, kRow, vec2(0.5f));
    const double angle = 2 * kPiD / kWidth * (std::cos(kPiD * kRow / kHeight) - std::cos(kPiD * (kRow + 1) / kHeight));
    const vec3 normal = glm::normalize(towards + vec3(0.3f, 0.2f, -0.1f));
    const Estimate e = estimate(receiver(vec3(0.0f), normal), 512, 64);
    const double expected = 1e4 * angle * static_cast<double>(glm::dot(normal, towards));
    printf("  %-6s one texel, turned by %.1f: %.6f, expected %.6f (standard error %.4f %%)\n", GetParam(), static_cast<double>(turn), e.mean, expected, 100 * e.error / expected);
    EXPECT_NEAR(e.mean, expected, 3 * e.error + 1e-3 * expected);  // within the texel the cosine is not quite the middle's
    EXPECT_LT(e.error, 0.001 * expected);
    const vec3 across = glm::normalize(glm::cross(towards, vec3(0, 1, 0))), along = glm::cross(across, towards);
    test::addQuad(s, towards - across - along, 2.0f * across, 2.0f * along, test::addMaterial(s));
    use(std::move(s));
    EXPECT_EQ(estimate(receiver(vec3(0.0f), normal), 64, 16).mean, 0);
  }
  // Beside the sky and an emitter each has its own share.
  Scene all = square();
  all.sky = vec3(0.5f);
  all.environment = test::mapOf(8, 4, [](int, int y) { return vec3(y < 2 ? 1.0f : 0.0f); });
  use(std::move(all));
  const double blocked = kCentredSquare * kPiD;
  expectIrradiance("square, sky and map", estimate(receiver(vec3(0.0f), {0, 1, 0}), 2048, 64), kCentredSquare * kPiD * 2 + 1.5 * (kPiD - blocked));
}

TEST_P(DirectLightTest, BoxWhoseWallsAllShine) {
  // Every direction of every point's hemisphere brings radiance 1: irradiance is pi, in the middle of a wall, near an
  // edge and in a corner.
  Scene s;
  test::addRoom(s, -1, 1, test::addMaterial(s, vec3(1.0f)));
  use(std::move(s));
  std::vector<SurfacePoint> points;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x)
      points.push_back(
          receiver({(static_cast<float>(x) + 0.5f) / 24 - 1, -1, (static_cast<float>(y) + 0.5f) / 24 - 1}, {0, 1, 0}));
  const std::vector<vec4> sums = irradiance(points, 64);
  double sum = 0, squares = 0;
  for (const vec4& v : sums) {
    const double e = static_cast<double>(v.x) / static_cast<double>(v.w) / kPiD;
    sum += e, squares += (e - 1) * (e - 1);
  }
  const double n = static_cast<double>(points.size());
  printf("  %-6s all walls shine: mean %.6f of pi, deviation of a point %.3f %%\n", GetParam(), sum / n,
         100 * std::sqrt(squares / n));
  EXPECT_NEAR(sum / n, 1, 0.001);
  EXPECT_LT(std::sqrt(squares / n), 0.025);  // 1.6 % when written
  expectIrradiance("next to a corner", estimate(receiver({-0.999f, -1, -0.999f}, {0, 1, 0}, 1e-6f), 2048, 64), kPiD);
}

TEST_P(DirectLightTest, ManyEmittersOfUnequalPower) {
  // 400 small squares and one large bright one: the sum of their closed forms, found by the same oracle as the
  // reference's.
  Scene s;
  shared::Random r = shared::randomInit(4, 2, 0);
  double expected = 0;
  const auto add = [&](vec3 p, float size, float radiance) {
    test::addQuad(s, p, vec3(size, 0, 0), vec3(0, 0, size), test::addMaterial(s, vec3(radiance)));
    // Lambert's polygon sum in double precision; the receiver is the origin, facing up.
    const glm::dvec3 a(p), x(static_cast<double>(size), 0, 0), z(0, 0, static_cast<double>(size));
    const glm::dvec3 corners[4] = {a, a + x, a + x + z, a + z};
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
      const glm::dvec3 m = glm::cross(corners[i], corners[(i + 1) % 4]);
      sum += m.y / glm::length(m) * std::atan2(glm::length(m), glm::dot(corners[i], corners[(i + 1) % 4]));
    }
    expected += std::abs(sum) / 2 * static_cast<double>(radiance);
  };
  for (int i = 0; i < 400; ++i)
    add({shared::randomFloat(r) * 4 - 2, 1 + static_cast<float>(i) * 1e-4f, shared::randomFloat(r) * 4 - 2}, 0.01f,
        20 * shared::randomFloat(r));
  add({0.5f, 1.2f, 0.5f}, 0.5f, 5);
  use(std::move(s));
  // The small squares shade one another and the large one by less than a part in a thousand: they are 0.04 m^2 spread
  // over 16.
  const Estimate e = estimate(receiver(vec3(0.0f), {0, 1, 0}), 4096, 64);
  printf("  %-6s many emitters: %.6f, expected %.6f, standard error %.4f %%\n", GetParam(), e.mean, expected,
         100 * e.error / expected);
  EXPECT_NEAR(e.mean, expected, 3 * e.error + 0.003 * expected);
}

TEST_P(DirectLightTest, SamplesOfAPointAreStratified) {
  // The error of a point's own mean falls faster than by the square root: with 16 times the samples by more than 5.
  use(square());
  const auto deviation = [&](uint32_t samples) {
    return estimate(receiver(vec3(0.0f), {0, 1, 0}), 1024, samples).error;
  };
  const double few = deviation(4), many = deviation(64);
  printf("  %-6s standard error falls %.1f times from 4 to 64 samples\n", GetParam(), few / many);
  EXPECT_GT(few / many, 5);
}

TEST_P(DirectLightTest, TheSameToTheBit) {
  Scene s = square();
  s.sky = vec3(0.3f);
  s.pointLights.push_back({"lamp", vec3(0.1f, 0.7f, 0.2f), vec3(1.0f)});
  use(std::move(s));
  const std::vector<SurfacePoint> points(500, receiver({0.1f, 0, 0.2f}, {0, 1, 0}));
  const std::vector<vec4> a = irradiance(points, 5), b = irradiance(points, 5), c = irradiance(points, 5, 2);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(vec4)), 0);
  EXPECT_NE(std::memcmp(a.data(), c.data(), a.size() * sizeof(vec4)), 0);
  EXPECT_NE(a[0].x, a[1].x) << "points share one random sequence";
}

TEST_P(DirectLightTest, PointsWithoutSurfaceReceiveNothing) {
  Scene s = square();
  s.sky = vec3(1.0f);
  s.directionalLights.push_back({"sun", {0, -1, 0}, vec3(1.0f)});
  use(std::move(s));
  SurfacePoint none{};
  const std::vector<vec4> sums = irradiance({none, receiver(vec3(0.0f), {0, 1, 0}), none}, 2);
  EXPECT_EQ(sums[0], vec4(0, 0, 0, 2));
  EXPECT_GT(sums[1].x, 0);
  EXPECT_EQ(sums[2], vec4(0, 0, 0, 2));
}

TEST_P(DirectLightTest, PartOfABuffer) {
  Scene s;
  s.pointLights.push_back({"lamp", vec3(0, 1, 0), vec3(1.0f)});
  use(std::move(s));
  const std::vector<SurfacePoint> points(10, receiver(vec3(0.0f), {0, 1, 0}));
  const Buffer in = device->buffer("points", std::span<const SurfacePoint>(points)),
               out = device->buffer("irradiance", 10 * sizeof(vec4));
  FrameGraph graph(*device, *shaders);
  graph.clear("clear", out);
  light->record(graph, "direct", in, out, 3, 4, 1, 0);
  EXPECT_THROW(light->record(graph, "direct", in, out, 7, 4, 1, 0), Error);
  graph.execute();
  std::vector<vec4> sums(10);
  device->download(out, sums.data(), sums.size() * sizeof(vec4));
  for (size_t i = 0; i < sums.size(); ++i) EXPECT_EQ(sums[i].x, i >= 3 && i < 7 ? 1.0f : 0.0f) << i;
}

std::string skippedBecause(const BatchTimings& t, const std::string& pass) {
  for (const PassTiming& p : t.passes)
    if (p.name == pass) return p.skipped;
  return "(not listed)";
}

TEST_P(DirectLightTest, WithoutLightsThePassesAreSkipped) {
  Scene s;
  test::addRoom(s, -1, 1, test::addMaterial(s));
  use(std::move(s));
  const Buffer in = device->buffer("points", sizeof(SurfacePoint)), out = device->buffer("irradiance", sizeof(vec4));
  FrameGraph graph(*device, *shaders);
  light->record(graph, "texels", in, out, 0, 1, 1, 0);
  const BatchTimings t = graph.execute();
  for (const char* pass : {"texels: sample lights", "texels: shadow rays", "texels: accumulate"})
    EXPECT_EQ(skippedBecause(t, pass), "scene has no lights") << pass;
}

/// A G-buffer of a floor at y = 0 under the unit square, its last column without surface.
TEST_P(DirectLightTest, PixelsSettleOnTheMean) {
  Scene s = square(vec3(1.0f));
  s.pointLights.push_back({"lamp", vec3(0, 0.5f, 0), vec3(0.25f)});
  use(std::move(s));
  const int width = 33, height = 20;
  const auto pixels = static_cast<size_t>(width * height);
  GBuffer g;
  g.width = width, g.height = height;
  std::vector<vec4> position(pixels), normal(pixels, vec4(0, 1, 0, 0));
  std::vector<uvec2> ids(pixels, uvec2(1, 0));
  for (size_t i = 0; i < pixels; ++i)
    position[i] = i % 33 == 32
                      ? vec4(0.0f)
                      : vec4(static_cast<float>(i % 33) / 33 - 0.5f, 0, static_cast<float>(i / 33) / 20 - 0.5f, 1);
  const auto image = [&](const char* name, Format format, const void* data, uint64_t bytes) {
    GpuImage out = device->image(name, {width, height, format});
    device->upload(out, 0, data, bytes);
    return out;
  };
  g.position = image("position", Format::RGBA32F, position.data(), pixels * sizeof(vec4));
  g.normal = image("normal", Format::RGBA32F, normal.data(), pixels * sizeof(vec4));
  g.geometricNormal = image("geometric normal", Format::RGBA32F, normal.data(), pixels * sizeof(vec4));
  g.ids = image("ids", Format::RG32U, ids.data(), pixels * sizeof(uvec2));

  DirectParams params;
  params.samples = 50, params.samples_per_frame = 8;
  FrameGraph graph(*device, *shaders);
  GpuImage result;
  Image first, last;
  int frames = 0;
  while (!light->settled(params) && frames < 100) {
    result = light->recordPixels(graph, g, params, 1);
    const BatchTimings t = graph.execute();
    EXPECT_EQ(skippedBecause(t, "direct punctual: shadow rays"), frames == 0 ? "" : "settled");
    EXPECT_EQ(skippedBecause(t, "direct: shadow rays"), "");
    last = device->download(result);
    if (frames++ == 0) first = last;
  }
  EXPECT_EQ(frames, 7);
  light->recordPixels(graph, g, params, 1);
  const BatchTimings settled = graph.execute();
  for (const char* pass : {"direct: sample lights", "direct: shadow rays", "direct: accumulate", "direct: mean"})
    EXPECT_EQ(skippedBecause(settled, pass), "settled") << pass;
  EXPECT_EQ(device->download(result).data, last.data);

  // The middle pixels against the service's own points, whose closed forms are tested above.
  double sum = 0;
  std::vector<SurfacePoint> points;
  for (size_t i = 0; i < pixels; ++i) points.push_back(receiver(vec3(position[i].x, 0, position[i].z), {0, 1, 0}));
  const std::vector<vec4> sums = irradiance(points, 50, 5);
  double expected = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const float value = last.data[4 * i];
    if (i % 33 == 32) {
      EXPECT_EQ(value, 0.0f);
      continue;
    }
    sum += static_cast<double>(value);
    expected += static_cast<double>(sums[i].x / sums[i].w);
  }
  EXPECT_NEAR(sum / expected, 1, 0.002);

  light->reset();
  result = light->recordPixels(graph, g, params, 1);
  graph.execute();
  EXPECT_EQ(device->download(result).data, first.data) << "after a reset the first frame comes again, to the bit";
  EXPECT_FALSE(light->settled(params));
}

TEST_P(DirectLightTest, PixelsWithoutLightsAreBlack) {
  Scene s;
  test::addRoom(s, -1, 1, test::addMaterial(s));
  use(std::move(s));
  GBuffer g;
  g.width = 4, g.height = 3;
  FrameGraph graph(*device, *shaders);
  const GpuImage result = light->recordPixels(graph, g, DirectParams{}, 1);
  const BatchTimings t = graph.execute();
  EXPECT_EQ(skippedBecause(t, "direct: sample lights"), "scene has no lights");
  for (const float v : device->download(result).data) EXPECT_EQ(v, 0.0f);
  EXPECT_TRUE(light->settled(DirectParams{}));
}

}  // namespace
}  // namespace hl
