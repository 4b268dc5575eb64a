// Sparse radiance probes against closed forms (MEASURES.md, section 1).
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/scene_file.h"
#include "tests/session_fixture.h"
#include "tests/srp_harness.h"

namespace hl::test {
namespace {

class SrpFurnace : public SessionTest {};

TEST_F(SrpFurnace, EveryOrderAndStorage) {
  // Emission 1, albedo 0.8: indirect E = pi 0.8 / 0.2.
  const double exact = static_cast<double>(kPi) * 0.8 / 0.2;
  SrpHarness h(loadScene("furnace_box_080"));
  h.set("lightmap.resolution", "32").set("srp.receiver_rays", "64").set("direct.lumel_samples", "64");
  h.set("srp.k", "4").set("probes.spacing", "0.34").set("srp.cache", "true");  // the second storage takes the first one's transport from there
  for (int order : {0, 1, 2, 3, 4, 5, 6, 7, 8}) {
    for (const char* storage : {"float32", "float16"}) {
      h.set("srp.sh_order", std::to_string(order)).set("srp.storage", storage);
      const std::vector<vec3> e = h.light();
      double worst = 0;
      for (const vec3& v : e) worst = std::max(worst, std::abs(static_cast<double>(v.y) / exact - 1));
      std::printf("order %d, %s: mean / exact = %.5f, worst %.4f\n", order, storage, h.mean(e) / exact, worst);
      EXPECT_NEAR(h.mean(e) / exact, 1, 0.01) << "order " << order << ", " << storage;
      EXPECT_LT(worst, 0.02);
    }
  }
  EXPECT_EQ(h.counter("invalid_receivers"), 0);
  EXPECT_EQ(h.counter("lightmap_nan_inf"), 0);
}

TEST_F(SrpFurnace, CompressedTo32Vectors) {
  const double exact = static_cast<double>(kPi) * 0.8 / 0.2;
  SrpHarness h(loadScene("furnace_box_080"));
  h.set("srp.receiver_rays", "128").set("direct.lumel_samples", "64").set("srp.compression", "cpca").set("srp.pca_vectors", "32");
  for (const char* clustering : {"aabb", "lbg"}) {
    for (const char* keep : {"false", "true"}) {
      h.set("srp.clustering", clustering).set("srp.pca_keep_constant", keep);
      const std::vector<vec3> e = h.light();
      double squares = 0;
      for (const vec3& v : e) squares += std::pow(static_cast<double>(v.y) / exact - 1, 2) / static_cast<double>(e.size());
      std::printf("32 vectors, %s, keep constant %s: mean / exact = %.5f, rms %.4f; Frobenius error %.4f, %.1f times smaller\n", clustering, keep, h.mean(e) / exact,
                  std::sqrt(squares), h.counter("cpca_relative_error"), h.counter("compression_ratio"));
      EXPECT_GT(h.counter("cpca_relative_error"), 0);
      // Plain components bound the norm of what is missing and promise nothing about constant light (README.md).
      EXPECT_NEAR(h.mean(e) / exact, 1, std::string(keep) == "true" ? 0.005 : 0.06) << clustering;
    }
  }
}

TEST(SrpPointLightCube, MatchesAtTheThreeInteriorPoints) {
  SrpHarness h(loadScene("point_light_cube"));
  h.set("lightmap.resolution", "96").set("srp.sh_order", "7").set("srp.receiver_rays", "256").set("probes.spacing", "0.25");
  const std::vector<vec3> e = h.light();
  const auto radianceAt = [&](float u, float v) {
    double sum = 0, weight = 0;
    for (size_t i = 0; i < e.size(); ++i) {
      const Lumel& l = h.atlas.lumels[i];
      const int axis = std::abs(l.normal.x) > 0.5f ? 0 : std::abs(l.normal.y) > 0.5f ? 1 : 2;
      const float a = std::abs(l.position[(axis + 1) % 3]) / 5, b = std::abs(l.position[(axis + 2) % 3]) / 5, texel = std::sqrt(l.area) / 5;
      for (const vec2 p : {vec2(u, v), vec2(v, u)}) {
        const float w = std::max(0.0f, 1 - std::abs(a - p.x) / texel) * std::max(0.0f, 1 - std::abs(b - p.y) / texel);
        sum += static_cast<double>(w * e[i].y), weight += static_cast<double>(w);
      }
    }
    return 2.0 / 3 / static_cast<double>(kPi) * sum / weight;
  };
  const double centre = radianceAt(0, 0), side = radianceAt(0, 0.5f), diagonal = radianceAt(0.5f, 0.5f);
  std::printf("point-light cube, order 7: %.2f %.2f %.2f (exact 468.4 465.0 455.7)\n", centre, side, diagonal);
  EXPECT_NEAR(centre, 468.4, 468.4 * 0.03);
  EXPECT_NEAR(side, 465.0, 465.0 * 0.03);
  EXPECT_NEAR(diagonal, 455.7, 455.7 * 0.03);
}

TEST(SrpInvariances, TwoLightsGiveTheSumAndMovingThemNeedsNoPrecomputation) {
  Scene both = loadScene("point_light_cube");
  both.pointLights = {{"a", vec3(1, 2, 0.5f), vec3(3000, 1000, 500)}, {"b", vec3(-2, -1, 1), vec3(200, 900, 2500)}};
  const std::vector<PointLight> lights = both.pointLights;
  SrpHarness h(std::move(both));
  h.set("srp.receiver_rays", "64").set("srp.compression", "cpca");
  const std::vector<vec3> sum = h.light();
  const double cast = h.counter("rays_cast");
  std::vector<vec3> parts(sum.size(), vec3(0.0f));
  for (const PointLight& light : lights) {
    h.scene.pointLights = {light};
    h.lightsEdited();
    const std::vector<vec3> one = h.settle();
    for (size_t i = 0; i < one.size(); ++i) parts[i] += one[i];
  }
  EXPECT_EQ(h.counter("rays_cast"), cast);
  double mean = 0, difference = 0;
  for (size_t i = 0; i < sum.size(); ++i) mean += static_cast<double>(luminance(sum[i])), difference += static_cast<double>(luminance(glm::abs(sum[i] - parts[i])));
  EXPECT_GT(mean, 0);
  // What is left of bounces that had not all come: 1e-3 of it, of each.
  EXPECT_LT(difference / mean, 3e-3);
}

TEST(SrpInvariances, ABlackSceneIsBlack) {
  Scene scene = loadScene("point_light_cube");
  for (Material& m : scene.materials) m.albedo = vec3(0.0f);
  SrpHarness h(std::move(scene));
  h.set("srp.receiver_rays", "16").set("lightmap.resolution", "32");
  for (const vec3& v : h.light()) EXPECT_EQ(v, vec3(0.0f));
}

}  // namespace
}  // namespace hl::test
