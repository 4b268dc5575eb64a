// What must not change the result, and what must change it in proportion: light, rotation, slices, the hit cache, the tracer.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/scene/scene_file.h"
#include "tests/technique_harness.h"

namespace hl::test {
namespace {

void small(TechniqueHarness& h, const char* resolution = "48", const char* samples = "128") {
  h.set("lightmap.resolution", resolution).set("radiosity.samples", samples).set("radiosity.bounces", "4").set("radiosity.residual", "0");
  h.set("direct.lumel_samples", "16");
}

bool sameBits(const std::vector<vec3>& a, const std::vector<vec3>& b) {
  return a.size() == b.size() && !a.empty() && std::memcmp(a.data(), b.data(), a.size() * sizeof(vec3)) == 0;
}

const PassTiming* passOf(const BatchTimings& batch, const std::string& name) {
  for (const PassTiming& p : batch.passes)
    if (p.name == name) return &p;
  return nullptr;
}

TEST(RadiosityInvariance, TwiceTheLightIsTwiceTheResultAndNeedsNoRays) {
  TechniqueHarness h("radiosity", loadScene("point_light_cube"));
  small(h);
  const std::vector<vec3> once = h.bake();
  h.scene.pointLights[0].intensity *= 2.0f;
  h.relight();
  h.work(h.technique->work().total - h.technique->work().done);
  const std::vector<vec3> twice = h.technique->lightmapIrradiance();
  ASSERT_TRUE(h.technique->work().settled());
  ASSERT_EQ(once.size(), twice.size());
  for (size_t i = 0; i < once.size(); ++i) ASSERT_EQ(2.0f * once[i], twice[i]) << i;
  const PassTiming* cast = passOf(h.last, "radiosity: cast rays");
  ASSERT_NE(cast, nullptr);
  EXPECT_EQ(cast->skipped, "hits are remembered");
}

TEST(RadiosityInvariance, LightsAdd) {
  // Power-of-two intensities, so that sums round alike: lamp a, lamp b, both.
  Scene scene = loadScene("point_light_cube");
  PointLight a = scene.pointLights[0], b = a;
  a.position = vec3(1, 2, 0), b.position = vec3(-2, 0.5f, 1);
  TechniqueHarness h("radiosity", scene);
  small(h);
  h.scene.pointLights = {a, b};
  h.rebuild();
  h.work();
  const double both = h.meanLuminance(h.technique->lightmapIrradiance());
  double sum = 0;
  for (const PointLight& only : {a, b}) {
    h.scene.pointLights = {only};
    h.relight();
    h.work();
    sum += h.meanLuminance(h.technique->lightmapIrradiance());
  }
  EXPECT_NEAR(both / sum, 1, 1e-6);
}

TEST(RadiosityInvariance, RotatedSceneIsTheSameWithinNoise) {
  Scene scene = loadScene("point_light_cube");
  TechniqueHarness straight("radiosity", scene);
  small(straight, "64", "256");
  const std::vector<vec3> a = straight.bake();
  // A turn about no axis in particular.
  const float c = std::cos(0.7f), s = std::sin(0.7f), k = std::cos(-1.1f), l = std::sin(-1.1f);
  const mat3 turn = mat3(vec3(c, 0, -s), vec3(0, 1, 0), vec3(s, 0, c)) * mat3(vec3(1, 0, 0), vec3(0, k, l), vec3(0, -l, k));
  for (vec3& p : scene.positions) p = turn * p;
  for (vec3& n : scene.normals) n = turn * n;
  scene.bounds = {};
  for (const vec3& p : scene.positions) scene.bounds.extend(p);
  TechniqueHarness turned("radiosity", scene);
  small(turned, "64", "256");
  const std::vector<vec3> b = turned.bake();
  ASSERT_EQ(a.size(), b.size());
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += std::pow(static_cast<double>(b[i].y / a[i].y) - 1, 2) / static_cast<double>(a.size());
  std::printf("rotation: mean ratio %.6f, rms of texels %.5f\n", turned.meanLuminance(b) / straight.meanLuminance(a), std::sqrt(squares));
  EXPECT_NEAR(turned.meanLuminance(b) / straight.meanLuminance(a), 1, 5e-4);
  EXPECT_LT(std::sqrt(squares), 0.01);
}

TEST(RadiosityInvariance, SlicesCacheAndRestartsChangeNoBit) {
  const Scene scene = loadScene("cornell_box");
  TechniqueHarness h("radiosity", scene);
  small(h);
  const std::vector<vec3> one = h.bake();
  const double backFaces = h.counter("back_face_hits"), withoutTexel = h.counter("hits_without_texel");
  EXPECT_GT(h.meanLuminance(one), 0);

  // Three units a submission, a cancelled start before, and a reset in the middle.
  h.technique->reset();
  h.work(7);
  h.technique->reset();
  EXPECT_EQ(h.technique->work().done, 0u);
  while (!h.technique->work().settled()) {
    for (int i = 0; i < 3; ++i) h.technique->recordWork(*h.graph);
    h.graph->execute();
  }
  EXPECT_TRUE(sameBits(one, h.technique->lightmapIrradiance()));
  EXPECT_EQ(h.counter("back_face_hits"), backFaces);
  EXPECT_EQ(h.counter("hits_without_texel"), withoutTexel);

  // No cache, and one that holds a part of the texels; by either way of casting, and with samples that leave a packet part empty.
  for (const char* tracer : {"embree", "bvh"}) {
    TechniqueHarness whole("radiosity", scene, tracer);
    small(whole, "96", "100");
    const std::vector<vec3> all = whole.bake();
    for (const char* megabytes : {"0", "1"}) {
      TechniqueHarness other("radiosity", scene, tracer);
      small(other, "96", "100");
      other.set("radiosity.hit_cache_mb", megabytes);
      EXPECT_TRUE(sameBits(all, other.bake())) << tracer << " " << megabytes << " MiB";
      EXPECT_EQ(whole.counter("back_face_hits"), other.counter("back_face_hits"));
      EXPECT_EQ(whole.counter("hits_without_texel"), other.counter("hits_without_texel"));
    }
  }
}

TEST(RadiosityInvariance, SameAgainAndOtherSeedOther) {
  const Scene scene = loadScene("cornell_box");
  TechniqueHarness a("radiosity", scene), b("radiosity", scene), c("radiosity", scene);
  c.seed = 2;
  for (TechniqueHarness* h : {&a, &b, &c}) small(*h);
  const std::vector<vec3> first = a.bake(), again = b.bake(), other = c.bake();
  EXPECT_TRUE(sameBits(first, again));
  EXPECT_FALSE(sameBits(first, other));
  EXPECT_NEAR(c.meanLuminance(other) / a.meanLuminance(first), 1, 0.01);
}

TEST(RadiosityInvariance, TracersAgree) {
  const Scene scene = loadScene("cornell_box");
  TechniqueHarness embree("radiosity", scene), bvh("radiosity", scene, "bvh");
  small(embree, "32", "64");
  small(bvh, "32", "64");
  const std::vector<vec3> a = embree.bake(), b = bvh.bake();
  EXPECT_NEAR(bvh.meanLuminance(b) / embree.meanLuminance(a), 1, 1e-4);
  // The one makes and uses its rays on the host, the other on the device: but for rays that round to the texel next door they are the same.
  double squares = 0, sum = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += static_cast<double>(glm::dot(b[i] - a[i], b[i] - a[i])), sum += static_cast<double>(glm::dot(a[i], a[i]));
  std::printf("tracers: rms of texels %.6f of the light\n", std::sqrt(squares / sum));
  EXPECT_LT(std::sqrt(squares / sum), 2e-3);
  EXPECT_NEAR(bvh.counter("back_face_hits"), embree.counter("back_face_hits"), 1e-3 * embree.counter("back_face_hits") + 5);
}

TEST(RadiosityWork, StopsAtTheResidual) {
  TechniqueHarness h("radiosity", loadScene("furnace_box_050"));
  small(h, "32", "16");
  h.set("radiosity.bounces", "64").set("radiosity.residual", "0.01");
  h.bake();
  // Bounce k adds rho^k of sum rho ... rho^k: below 1 % from k = 7 on.
  EXPECT_EQ(h.counter("bounces"), 7);
  EXPECT_LT(h.counter("residual"), 0.01);
  const WorkState w = h.technique->work();
  EXPECT_TRUE(w.settled());
  EXPECT_EQ(w.done, w.total);
}

TEST(RadiosityWork, UnitsAreCountedRight) {
  TechniqueHarness h("radiosity", loadScene("cornell_box"));
  small(h, "64");
  h.set("radiosity.bounces", "3");
  h.rebuild();
  const uint64_t total = h.technique->work().total;
  uint64_t units = 0;
  while (!h.technique->work().settled()) h.work(1), ++units;
  EXPECT_EQ(units, total);
}

TEST(RadiosityEdge, BackFacesReflectNothingAndAreCounted) {
  // A floor under a roof whose back looks down, lit from below the roof: the roof reflects nothing to the floor.
  Scene scene;
  scene.materials.push_back({});
  const auto quad = [&](vec3 a, vec3 u, vec3 v) {
    const auto base = static_cast<uint32_t>(scene.positions.size());
    for (vec3 p : {a, a + u, a + u + v, a + v}) {
      scene.positions.push_back(p);
      scene.normals.push_back(glm::normalize(glm::cross(u, v)));
      scene.uvs.push_back(vec2(0.0f));
      scene.bounds.extend(p);
    }
    for (uvec3 t : {uvec3(0, 1, 2), uvec3(0, 2, 3)}) {
      scene.indices.push_back(t + base);
      scene.materialIds.push_back(0);
      scene.objectIds.push_back(0);
    }
  };
  scene.objects = {"all"};
  quad(vec3(-1, 0, 1), vec3(2, 0, 0), vec3(0, 0, -2));
  quad(vec3(-1, 1, 1), vec3(2, 0, 0), vec3(0, 0, -2));
  PointLight lamp;
  lamp.position = vec3(0, 0.5f, 0);
  scene.pointLights = {lamp};
  scene.cameras.push_back({});
  TechniqueHarness h("radiosity", scene);
  small(h, "32", "64");
  // Both floors see the open or a back: no texel is inside, for most rays of neither meet a back at more than half.
  const std::vector<vec3> e = h.bake();
  for (const vec3& v : e) ASSERT_EQ(v, vec3(0.0f));
  EXPECT_GT(h.counter("back_face_hits"), 0);
}

TEST(RadiosityEdge, NoLightsAndOneTriangle) {
  Scene scene;
  scene.materials.push_back({});
  scene.objects = {"one"};
  scene.positions = {vec3(0), vec3(1, 0, 0), vec3(0, 1, 0)};
  scene.normals.assign(3, vec3(0, 0, 1));
  scene.uvs.assign(3, vec2(0.0f));
  scene.indices = {uvec3(0, 1, 2)};
  scene.materialIds = scene.objectIds = {0};
  for (vec3 p : scene.positions) scene.bounds.extend(p);
  TechniqueHarness h("radiosity", scene);
  small(h, "32", "16");
  const std::vector<vec3> e = h.bake();
  ASSERT_FALSE(e.empty());
  for (const vec3& v : e) ASSERT_EQ(v, vec3(0.0f));
  EXPECT_TRUE(h.technique->work().settled());
}

}  // namespace
}  // namespace hl::test
