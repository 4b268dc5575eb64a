// Environment maps on the host: the mapping, its sampling, the reference's light from it, and what is wrong with a file.
#include "engine/scene/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "engine/core/image_io.h"
#include "engine/scene/scene_build.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_pack.h"
#include "tests/analytic/reference_fixture.h"
#include "tests/environment_maps.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

using namespace test;
constexpr double kPiD = 3.14159265358979323846;

Environment oneTexel(int width, int height, int atX, int atY, float radiance) {
  return mapOf(width, height, [=](int x, int y) { return vec3(x == atX && y == atY ? radiance : 0.0f); });
}
Environment varied() {
  return mapOf(16, 8, [](int x, int y) { return vec3(1 + std::sin(static_cast<float>(x)), 0.2f * static_cast<float>(y), x == 5 ? 30.0f : 0.1f); });
}
double solidAngle(int width, int height, int y) { return 2 * kPiD / width * (std::cos(kPiD * y / height) - std::cos(kPiD * (y + 1) / height)); }

ReferenceSettings quick(int samples) {
  ReferenceSettings s;
  s.samplesPerPixel = samples, s.directSamples = samples;
  return s;
}
/// Copies of one receiver, so that the noise tells itself.
std::vector<Receiver> copies(vec3 position, vec3 normal, size_t n = 64) { return std::vector<Receiver>(n, receiverAt(position, normal)); }

TEST(EnvironmentMap, WhereThingsAre) {
  const EnvironmentLight map(mapOf(4, 2, [](int x, int y) { return vec3(static_cast<float>(1 + x + 10 * y)); }));
  // From the middle: straight ahead (-Z) is between the two middle columns, to the right is +X, behind is at the edges.
  EXPECT_EQ(map.radiance({0.01f, 0.5f, -1}).x, 3);
  EXPECT_EQ(map.radiance({-0.01f, 0.5f, -1}).x, 2);
  EXPECT_EQ(map.radiance({1, 0.5f, 0.01f}).x, 4);
  EXPECT_EQ(map.radiance({-1, -0.5f, 0.01f}).x, 11);
  Environment turned = mapOf(4, 1, [](int x, int) { return vec3(static_cast<float>(1 + x)); });
  turned.rotation = kPi / 2;  // clockwise seen from above: what was ahead is to the right
  EXPECT_EQ(EnvironmentLight(turned).radiance({1, 0, -0.01f}).x, 2);
  EXPECT_EQ(EnvironmentLight(turned).radiance({1, 0, 0.01f}).x, 3);
}

TEST(EnvironmentMap, SamplesLandWhereTheirRadianceIsAndDensitiesAddUp) {
  Environment e = varied();
  e.rotation = 1.1f;
  const EnvironmentLight map(e);
  double power = 0, powerBySamples = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) power += solidAngle(16, 8, y) * static_cast<double>(luminance(e.radiance[static_cast<size_t>(y * 16 + x)]));
  EXPECT_NEAR(static_cast<double>(map.info().power) / power, 1, 1e-6);
  vec3 flux(0.0f);
  constexpr uint32_t kSamples = 1 << 16;
  int elsewhere = 0;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const EnvironmentSample s = map.sample(shared::sobolPoint(i, uvec2(0)));
    ASSERT_GT(s.pdf, 0);
    EXPECT_NEAR(glm::length(s.direction), 1, 1e-5f);
    elsewhere += map.radiance(s.direction) != s.radiance;  // rounding, on the very edge between two texels
    powerBySamples += static_cast<double>(luminance(s.radiance) / s.pdf) / kSamples;
    flux += s.radiance / s.pdf / static_cast<float>(kSamples);
  }
  EXPECT_LE(elsewhere, 20);
  EXPECT_NEAR(powerBySamples / power, 1, 1e-5);
  double blue = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) blue += solidAngle(16, 8, y) * static_cast<double>(e.radiance[static_cast<size_t>(y * 16 + x)].z);
  EXPECT_NEAR(static_cast<double>(flux.z) / blue, 1, 0.005);
}

TEST(EnvironmentMap, ConstantMapIsAConstantSky) {
  Scene sky, map;
  for (Scene* s : {&sky, &map}) addQuad(*s, vec3(-50, 0, -50), vec3(0, 0, 100), vec3(100, 0, 0), addMaterial(*s, vec3(0.5f)));
  sky.sky = vec3(2, 1, 0.5f);
  map.environment = mapOf(8, 4, [](int, int) { return vec3(2, 1, 0.5f); });
  const auto points = copies(vec3(0, 1e-3f, 0), glm::normalize(vec3(1, 0.5f, 0)));
  const auto a = trace(sky, points, quick(1024)), b = trace(map, points, quick(1024));
  for (const bool direct : {true, false}) {
    const Estimate x = meanOf(direct ? a->directImage() : a->indirectImage(kAllBounces), true), y = meanOf(direct ? b->directImage() : b->indirectImage(kAllBounces), true);
    EXPECT_NEAR(x.value, y.value, 3 * std::hypot(x.error, y.error) + 1e-4 * x.value) << (direct ? "direct" : "indirect");
    EXPECT_GT(x.value, 0.1);
  }
}

TEST(EnvironmentMap, HalfASky) {
  Scene s;
  s.environment = mapOf(8, 4, [](int, int y) { return vec3(y < 2 ? 1.0f : 0.0f); });
  for (const float t : {0.0f, 0.7f, 1.5f, 2.4f}) {
    const Estimate e = meanOf(trace(s, copies(vec3(0.0f), {std::sin(t), std::cos(t), 0}), quick(1024))->directImage(), true);
    const double expected = kPiD * (1 + std::cos(static_cast<double>(t))) / 2;
    EXPECT_NEAR(e.value, expected, 3 * e.error + 1e-4 * expected) << t;
    EXPECT_LT(e.error, 0.01 * kPiD);
  }
}

TEST(EnvironmentMap, OneBrightTexelIsADirectionalLightWhereverItIsTurned) {
  // A texel of 1/64 x 1/128 of half a turn: over it the cosine hardly changes. Lit from it directly, and by one bounce off a floor.
  constexpr int kWidth = 256, kHeight = 128, kRow = 30;
  const double energy = 1e4 * solidAngle(kWidth, kHeight, kRow);
  for (const float turn : {0.0f, 1.0f, -2.5f}) {
    Scene sun, map;
    map.environment = oneTexel(kWidth, kHeight, 200, kRow, 1e4f);
    map.environment.rotation = turn;
    const shared::EnvironmentInfo info = EnvironmentLight(map.environment).info();
    const vec3 towards = shared::environmentDirection(info, 200, kRow, vec2(0.5f));
    sun.directionalLights.push_back({"sun", -towards, vec3(static_cast<float>(energy))});
    for (Scene* s : {&sun, &map}) addQuad(*s, vec3(-50, 0, -50), vec3(0, 0, 100), vec3(100, 0, 0), addMaterial(*s, vec3(0.5f)));
    const auto points = copies(vec3(0, 0.01f, 0), glm::normalize(vec3(towards.x, 0.2f, towards.z)));
    const auto a = trace(sun, points, quick(512)), b = trace(map, points, quick(512));
    const Estimate direct = meanOf(b->directImage(), true), expected = meanOf(a->directImage(), true);
    EXPECT_NEAR(direct.value, expected.value, 3 * direct.error + 2e-3 * expected.value) << "turned by " << turn;
    EXPECT_LT(direct.error, 2e-3 * expected.value);
    const Estimate one = meanOf(a->indirectImage(1), true), other = meanOf(b->indirectImage(1), true);
    EXPECT_NEAR(other.value, one.value, 3 * std::hypot(one.error, other.error) + 2e-3 * one.value);
  }
}

TEST(EnvironmentMap, ScaleAndRotationAreContent) {
  Scene s;
  s.environment = varied();
  const std::string plain = sceneContentHash(s);
  s.environment.rotation = 0.1f;
  EXPECT_NE(sceneContentHash(s), plain);
  s.environment.rotation = 0, s.environment.scale = vec3(2.0f);
  EXPECT_NE(sceneContentHash(s), plain);
  EXPECT_FLOAT_EQ(EnvironmentLight(s.environment).info().power, 2 * EnvironmentLight(varied()).info().power);
  EXPECT_TRUE(sceneFeatures(s).environment && sceneFeatures(s).anyLight());
  s.environment.scale = vec3(0.0f);
  EXPECT_FALSE(sceneFeatures(s).environment) << "a black map shines no more than none";
}

class EnvironmentFiles : public testing::Test {
 protected:
  std::filesystem::path write(const std::function<void(Image&)>& change, const std::string& more = "") {
    Image image(8, 4, 3);
    for (float& v : image.data) v = 0.5f;
    change(image);
    writeImage(folder / "sky.pfm", image);
    const std::filesystem::path file = folder / "scene.json";
    std::ofstream(file) << R"({"version": 1, "shapes": [{"type": "box", "material": "m", "min": [0, 0, 0], "max": [1, 1, 1]}], "materials": {"m": {"albedo": 0.5}},
      "probes": [[1, 2, 3]], "environment": {"file": "sky.pfm", "rotation_degrees": 90, "scale": 2)"
                        << more << "}}";
    return file;
  }
  std::string messageOf(const std::filesystem::path& file) {
    try {
      loadScene(file.string());
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::BadInput);
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
    return "";
  }
  TemporaryFolder folder;
};

TEST_F(EnvironmentFiles, LoadedAndPacked) {
  const Scene s = loadScene(write([](Image& i) { i.pixel(3, 1)[1] = -0.25f; }).string());
  EXPECT_EQ(s.environment.width, 8);
  EXPECT_FLOAT_EQ(s.environment.rotation, kPi / 2);
  EXPECT_EQ(s.environment.scale, vec3(2.0f));
  EXPECT_EQ(s.environment.radiance[8 + 3].y, 0);
  ASSERT_EQ(s.report.warnings.size(), 1u);
  EXPECT_NE(s.report.warnings[0].find("1 texels below 0"), std::string::npos);
  const Scene back = unpackScene(packScene(s));
  EXPECT_EQ(back.environment.radiance, s.environment.radiance);
  EXPECT_EQ(back.environment.rotation, s.environment.rotation);
  EXPECT_EQ(back.environment.scale, s.environment.scale);
  EXPECT_EQ(back.probes, s.probes);
  EXPECT_EQ(back.probes, (std::vector<vec3>{{1, 2, 3}}));
}

TEST_F(EnvironmentFiles, WhatIsWrongIsSaidInOneLine) {
  EXPECT_NE(messageOf(write([](Image& i) { i.pixel(2, 3)[0] = std::numeric_limits<float>::quiet_NaN(); })).find("texel (2, 3)"), std::string::npos);
  EXPECT_NE(messageOf(write([](Image& i) { i.pixel(0, 0)[2] = std::numeric_limits<float>::infinity(); })).find("texel (0, 0)"), std::string::npos);
  EXPECT_NE(messageOf(write([](Image&) {}, ", \"turn\": 3")).find("turn"), std::string::npos);
  const std::filesystem::path file = write([](Image&) {}, ", \"obtain\": \"the moon\"");
  std::filesystem::remove(folder / "sky.pfm");
  const std::string missing = messageOf(file);
  EXPECT_NE(missing.find("environment map 'sky.pfm' is missing; get it from the moon"), std::string::npos) << missing;
  std::ofstream(folder / "sky.pfm") << "not an image";
  EXPECT_NE(messageOf(file).find("sky.pfm"), std::string::npos);
}

}  // namespace
}  // namespace hl
