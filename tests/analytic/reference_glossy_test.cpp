// The reference's glossy last bounce where the answer is known: uniform light, a mirror; and what it must leave alone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "engine/core/files.h"
#include "engine/reference/receivers.h"
#include "engine/reference/reference_state.h"
#include "shaders/shared/ggx.h"
#include "tests/analytic/reference_fixture.h"
#include "tests/ggx_integral.h"

namespace hl {
namespace {

using namespace hl::test;

/// On a surface that faces `normal`, seen at `cosine` to it.
Receiver glossyReceiver(vec3 position, vec3 normal, float cosine, float f0, float roughness) {
  Receiver r = receiverAt(position, normal);
  r.view = shared::fromLocal(vec3(std::sqrt(1 - cosine * cosine), 0, cosine), normal);
  r.specular = vec3(f0), r.roughness = roughness;
  return r;
}

ReferenceImage bucketOfLobes(const ReferenceResult& r, size_t bucket) {
  ReferenceImage i;
  i.halfA = r.specular[0][bucket], i.halfB = r.specular[1][bucket], i.mean = i.halfA;
  for (size_t k = 0; k < i.mean.data.size(); ++k) i.mean.data[k] = 0.5f * (i.halfA.data[k] + i.halfB.data[k]);
  return i;
}

// All walls of a room shine with radiance 1 and reflect rho of it: what they reflect comes in evenly with radiance rho^k of k bounces, and the lobe gives its
// directional albedo of that. The emission that the lobe sees itself is direct light, and apart.
TEST(ReferenceGlossy, UniformLightTimesTheDirectionalAlbedo) {
  constexpr double kRho = 0.5;
  Scene s;
  addRoom(s, vec3(-1.0f), vec3(1.0f), addMaterial(s, vec3(static_cast<float>(kRho)), vec3(1.0f)));
  struct Case {
    float cosine, f0, roughness;
  };
  const std::vector<Case> cases = {{1, 1, 0.5f}, {0.7f, 0.04f, 0.5f}, {0.3f, 0.5f, 0.2f}, {0.5f, 1, 1}, {0.9f, 0.8f, 0.05f}};
  constexpr int kEach = 32;
  std::vector<Receiver> receivers;
  for (const Case& c : cases)
    for (int i = 0; i < kEach; ++i)
      receivers.push_back(glossyReceiver(vec3(0.1f * static_cast<float>(i % 8) - 0.35f, -1, 0.1f * static_cast<float>(i / 8) - 0.35f), vec3(0, 1, 0), c.cosine, c.f0, c.roughness));
  ReferenceSettings settings;
  settings.samplesPerPixel = settings.directSamples = 512, settings.maxBounces = 3;
  const auto r = trace(s, receivers, settings);
  EXPECT_EQ(r->nonFinite, 0u);
  ASSERT_TRUE(r->glossy());
  const ReferenceImage all = r->specularImage(kAllBounces), first = bucketOfLobes(*r, 0), second = bucketOfLobes(*r, 1);
  for (size_t i = 0; i < cases.size(); ++i) {
    const double albedo = directionalAlbedo(static_cast<double>(cases[i].f0), static_cast<double>(cases[i].cosine), static_cast<double>(cases[i].roughness));
    const auto check = [&](const ReferenceImage& image, double radiance) {
      const Estimate e = meanOf(image, i * kEach, (i + 1) * kEach, true);
      EXPECT_NEAR(e.value, radiance * albedo, 4 * e.error + 1.5e-3 * radiance) << i;
      EXPECT_LT(e.error, 5e-3 * radiance) << i;
    };
    check(r->directSpecularImage(), 1), check(first, kRho), check(second, kRho * kRho), check(all, kRho + kRho * kRho + kRho * kRho * kRho);
  }
}

// What a smooth panel shows is what lies in the mirror's direction, times the Fresnel term.
TEST(ReferenceGlossy, SmoothPanelIsAMirror) {
  Scene s;
  const uint32_t grey = addMaterial(s, vec3(0.6f));
  addQuad(s, vec3(3, -50, -50), vec3(0, 0, 100), vec3(0, 100, 0), grey);  // a wall at x = 3 that faces -x
  const vec3 lamp(0.5f, 2, 0.4f);
  s.pointLights.push_back(pointLight(lamp, 100));
  const float cosine = std::sqrt(0.5f);
  std::vector<Receiver> receivers;
  for (int i = 0; i < 64; ++i) {
    Receiver r = glossyReceiver(vec3(0.0f), vec3(0, 1, 0), cosine, 0.7f, shared::kMinRoughness);
    r.view = vec3(-cosine, cosine, 0);
    receivers.push_back(r);
  }
  ReferenceSettings settings;
  settings.samplesPerPixel = 1024;
  const auto r = trace(s, receivers, settings);
  const vec3 seen(3, 3, 0), to = lamp - seen;
  const double d2 = static_cast<double>(glm::dot(to, to)), facing = static_cast<double>(-to.x) / std::sqrt(d2);
  const double radiance = 0.6 / kPiDouble * 100 * facing / d2;
  const Estimate e = meanOf(bucketOfLobes(*r, 0), true);
  // The peak's skirts reach 1 % of its weight, over light that changes little there.
  EXPECT_NEAR(e.value, radiance * ggxF(0.7, static_cast<double>(cosine)), 4 * e.error + 5e-3 * radiance);
  // The wall is alone: nothing comes after one bounce.
  EXPECT_EQ(meanOf(bucketOfLobes(*r, 1)).value, 0);
}

// A highlight is the lobe's value, without noise; of a sky, its directional albedo.
TEST(ReferenceGlossy, HighlightsOfLampsAndSky) {
  Scene s;
  addQuad(s, vec3(-50, -1, -50), vec3(0, 0, 100), vec3(100, 0, 0), addMaterial(s, vec3(0.0f)));
  const vec3 lamp(0.7f, 1.5f, -0.3f), sun = glm::normalize(vec3(-0.5f, -1, 0.2f));
  s.pointLights.push_back(pointLight(lamp, 10));
  DirectionalLight d;
  d.direction = sun, d.irradiance = vec3(3);
  s.directionalLights.push_back(d);
  struct Case {
    float cosine, f0, roughness;
  };
  const std::vector<Case> cases = {{0.8f, 0.5f, 0.5f}, {0.4f, 0.04f, 0.2f}, {0.9f, 1, 1}};
  std::vector<Receiver> receivers;
  for (const Case& c : cases) receivers.push_back(glossyReceiver(vec3(0.0f), vec3(0, 1, 0), c.cosine, c.f0, c.roughness));
  ReferenceSettings settings;
  settings.samplesPerPixel = 2, settings.directSamples = 4096;
  const auto highlights = [&] { return trace(s, receivers, settings)->directSpecularImage(); };
  const ReferenceImage punctual = highlights();
  s.pointLights.clear(), s.directionalLights.clear(), s.sky = vec3(2);
  const ReferenceImage sky = highlights();
  for (size_t i = 0; i < cases.size(); ++i) {
    const double f0 = static_cast<double>(cases[i].f0), roughness = static_cast<double>(cases[i].roughness);
    const auto local = [](vec3 v) { return glm::normalize(glm::dvec3(shared::toLocal(v, vec3(0, 1, 0)))); };
    const auto of = [&](vec3 to, double irradianceFacing) { return irradianceFacing * local(to).z * ggxLobe(local(receivers[i].view), local(to), f0, roughness * roughness); };
    const double truth = of(lamp, 10 / static_cast<double>(glm::dot(lamp, lamp))) + of(-sun, 3);
    EXPECT_NEAR(static_cast<double>(punctual.mean.data[3 * i]), truth, 1e-3 * truth) << i;
    EXPECT_EQ(punctual.halfA.data[3 * i], punctual.halfB.data[3 * i]);
    const Estimate e = meanOf(sky, i, i + 1, false);
    EXPECT_NEAR(e.value, 2 * directionalAlbedo(f0, static_cast<double>(cases[i].cosine), roughness), 0.02) << i;
  }
}

TEST(ReferenceGlossy, LightFromBelowTheSurfaceDoesNotCount) {
  Scene s;
  const uint32_t grey = addMaterial(s, vec3(0.5f), vec3(0.0f), true);
  addQuad(s, vec3(-50, -1, -50), vec3(0, 0, 100), vec3(100, 0, 0), grey);
  s.pointLights.push_back(pointLight(vec3(0, 1, 0), 100));
  Receiver up = glossyReceiver(vec3(0.0f), vec3(0, 1, 0), 0.5f, 1, 1), away = up, back = glossyReceiver(vec3(0.0f), vec3(0, -1, 0), 0.5f, 1, 1);
  away.view = vec3(0, -1, 0);  // seen from below: nothing is
  ReferenceSettings settings;
  settings.samplesPerPixel = 64;
  const auto r = trace(s, {up, away, back}, settings);
  const Image seen = r->specularImage(kAllBounces).mean;
  EXPECT_EQ(seen.data[0], 0) << "the floor lies below the receiver's horizon";
  EXPECT_EQ(seen.data[3], 0);
  EXPECT_GT(seen.data[6], 0) << "and above that of one that faces it";
}

class ReferenceGlossyRun : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() / ("halflight-glossy-" + std::to_string(::getpid()));
    setenv("HALFLIGHT_CACHE", folder.c_str(), 1);
    addRoom(scene, vec3(-1.0f), vec3(1.0f), addMaterial(scene, vec3(0.5f)));
    scene.pointLights.push_back(pointLight(vec3(0.2f, 0.3f, 0), 10));
    embree = std::make_shared<EmbreeScene>(scene);
    for (int i = 0; i < 16; ++i) {
      receivers.push_back(glossyReceiver(vec3(0.05f * static_cast<float>(i), -1, 0), vec3(0, 1, 0), 0.6f, 0.5f, 0.4f));
      if (i % 2) receivers.back().specular = vec3(0.0f);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
  std::unique_ptr<ReferenceTracer> tracer(int samples, bool lobes = true) {
    ReferenceSettings settings;
    settings.samplesPerPixel = samples, settings.glossyLastBounce = lobes;
    return std::make_unique<ReferenceTracer>(embree, receivers, 16, 1, settings, sharedPool());
  }
  static void expectSame(const std::array<Image, kBounceBuckets>& a, const std::array<Image, kBounceBuckets>& b) {
    for (size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].data, b[k].data) << k;
  }

  std::filesystem::path folder;
  Scene scene;
  std::shared_ptr<const EmbreeScene> embree;
  std::vector<Receiver> receivers;
};

TEST_F(ReferenceGlossyRun, LeavesIrradianceAsItIs) {
  const auto with = traceAll(*tracer(1024)), without = traceAll(*tracer(1024, false));
  ASSERT_TRUE(with->glossy());
  EXPECT_FALSE(without->glossy());
  EXPECT_NE(with->key, without->key);
  for (size_t half = 0; half < 2; ++half) {
    expectSame(with->indirect[half], without->indirect[half]);
    EXPECT_EQ(with->direct[half].data, without->direct[half].data);
  }
  const Image lobes = with->specularImage(kAllBounces).mean, none = without->specularImage(kAllBounces).mean;
  for (size_t i = 0; i < 16; ++i) EXPECT_EQ(lobes.data[3 * i] > 0, i % 2 == 0) << "diffuse receivers have no lobe";
  EXPECT_EQ(none.pixels(), 16u);
  for (const float x : none.data) EXPECT_EQ(x, 0);
  // Receivers without a lobe have the key, and so the cached references, that they had before there were lobes.
  for (Receiver& r : receivers) r.specular = vec3(0.0f);
  EXPECT_EQ(traceAll(*tracer(1024))->key, without->key);
}

TEST_F(ReferenceGlossyRun, ResumesToTheSameBits) {
  const auto whole = traceAll(*tracer(2048));
  const auto first = tracer(2048);
  Progress progress;
  while (first->done() < 0.5) first->advance(progress);
  first->store();
  const auto second = tracer(2048);
  second->resume();
  EXPECT_GT(second->done(), 0.4) << "nothing was found in the cache";
  const auto resumed = traceAll(*second);
  for (size_t half = 0; half < 2; ++half) {
    expectSame(whole->specular[half], resumed->specular[half]);
    expectSame(whole->indirect[half], resumed->indirect[half]);
    EXPECT_EQ(whole->directSpecular[half].data, resumed->directSpecular[half].data);
  }
  second->store();
  // Halves are independent: equal ones would tell of no noise.
  EXPECT_NE(whole->specular[0][0].data, whole->specular[1][0].data);
  for (const auto& e : std::filesystem::directory_iterator(folder / "references")) EXPECT_NO_THROW(checkReferenceFile(e.path().filename().string(), readFile(e.path())));
}

TEST_F(ReferenceGlossyRun, ReceiversHaveTheirMaterialsLobe) {
  scene.materials[0].specular = vec3(0.3f, 0.2f, 0.1f), scene.materials[0].roughness = 0.25f;
  Image position(1, 1, 4), normal(1, 1, 4);
  position.data = {0, -1, 0, 1}, normal.data = {0, 1, 0, 0};
  const std::vector<uint32_t> ids = {1, 0};
  const vec3 eye(0, 1, 0);
  const Receiver r = receiversFromGBuffer(position, normal, normal, ids, &scene, &eye)[0];
  EXPECT_EQ(r.view, vec3(0, 1, 0));
  EXPECT_EQ(r.specular, scene.materials[0].specular);
  EXPECT_EQ(r.roughness, 0.25f);
  EXPECT_FALSE(receiversFromGBuffer(position, normal, normal, ids, &scene)[0].glossy()) << "without an eye there is nobody to reflect to";
}

}  // namespace
}  // namespace hl
