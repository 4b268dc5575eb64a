// Sparse radiance probes against closed forms (MEASURES.md, section 1).
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/spherical_harmonics64.h"
#include "engine/scene/scene_file.h"
#include "engine/techniques/srp/precomputation.h"
#include "engine/techniques/srp/probe_frame.h"
#include "tests/session_fixture.h"
#include "tests/point_light_cube.h"
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
  h.set("srp.least_clusters", "1").set("srp.receiver_rays", "128").set("direct.lumel_samples", "64").set("srp.compression", "cpca").set("srp.pca_vectors", "32");
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
      EXPECT_NEAR(h.mean(e) / exact, 1, std::string(keep) == "true" ? 0.005 : 0.1) << clustering;
    }
  }
}

TEST(SrpPointLightCube, MatchesAtTheThreeInteriorPoints) {
  SrpHarness h(loadScene("point_light_cube"));
  h.set("lightmap.resolution", "96").set("srp.sh_order", "7").set("srp.receiver_rays", "256").set("probes.spacing", "0.25");
  const std::vector<vec3> e = h.light();
  const std::array<double, 3> found = cubeRadiance(h.atlas, e);
  std::printf("point-light cube, order 7: %.2f %.2f %.2f (exact %.1f %.1f %.1f)\n", found[0], found[1], found[2], kCubeRadiance[0], kCubeRadiance[1], kCubeRadiance[2]);
  for (size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], kCubeRadiance[i], 0.03 * kCubeRadiance[i]);
}

TEST(SrpTransport, HalfASkyIsExactFromOrderOne) {
  // A plate in the open, tilted by t; the sky above the horizon shines with radiance 1: E = pi (1 + cos t) / 2. Light of the probes is the sky's own projection, so that
  // what is tested is transport: cosine, misses, and that band-limiting loses nothing of E.
  for (const double tilt : {0.0, 0.7, 2.4}) {
    const vec3 normal(0, std::cos(static_cast<float>(tilt)), std::sin(static_cast<float>(tilt))), along(1, 0, 0), up = glm::cross(normal, along);
    Scene scene = loadScene("point_light_cube");
    scene.positions = {-0.5f * along - 0.5f * up, 0.5f * along - 0.5f * up, 0.5f * along + 0.5f * up, -0.5f * along + 0.5f * up};
    scene.indices = {uvec3(0, 1, 2), uvec3(0, 2, 3)};
    if (glm::dot(glm::cross(scene.positions[1] - scene.positions[0], scene.positions[2] - scene.positions[0]), normal) < 0) scene.indices = {uvec3(0, 2, 1), uvec3(0, 3, 2)};
    scene.normals.assign(4, normal), scene.uvs.assign(4, vec2(0.0f));
    scene.lightmapUvs.clear();
    scene.materialIds.assign(2, 0), scene.objectIds.assign(2, 0);
    scene.objects.resize(1);
    scene.bounds = {};
    for (vec3 p : scene.positions) scene.bounds.extend(p);
    scene.pointLights = {{"lamp", 2.0f * normal, vec3(1.0f)}};
    scene.probes = {normal * 0.3f, normal * 0.4f + 0.2f * along};
    SrpHarness h(std::move(scene));
    h.set("lightmap.resolution", "32").set("probes.placement", "manual");
    for (int order : {1, 8}) {
      h.set("srp.sh_order", std::to_string(order));
      h.rebuild();
      ASSERT_EQ(h.atlas.lumels.size() > 0, true);
      const LightmapTables tables = makeLightmapTables(h.scene, h.atlas, 0, h.progress);
      Buffer triangles = h.device->buffer("triangles", tables.triangles.size() * sizeof(vec4), TexelFormat::RGBA32F);
      h.device->upload(triangles, tables.triangles.data(), tables.triangles.size() * sizeof(vec4));
      SrpParams params;
      params.sh_order = order, params.receiver_rays = 1024, params.compression = kCompressionNone, params.cache = 0, params.surface_share = 0;
      Gpu gpu{*h.device, *h.shaders};
      const SceneView view{h.scene, h.features, h.gpuScene, *h.tracer, *h.directLight, h.pool, &h.atlas, h.lightmap, h.direct, 1, &h.placed};
      const Buffer lumelOfTexel = h.device->buffer("lumel of texel", std::span<const uint32_t>(tables.lumelOfTexel));
      Precomputation work(gpu, view, params, triangles, lumelOfTexel, nullptr, h.progress);
      while (!work.work().settled()) work.recordUnit(*h.graph), h.graph->execute();
      // The sky's coefficients: zonal about y, 2 pi times the integral of P_l over [0, 1], times Y_lm(y).
      const double integral[] = {1, 0.5, 0, -0.125, 0, 0.0625, 0, -0.0390625, 0};
      std::vector<sh64::ShCoefficients> axes;  // y in each probe's frame
      for (uint32_t p = 0; p < h.placed.count(); ++p)
        axes.push_back(sh64::shBasis(order, glm::dvec3(shared::rotated(vec3(0, 1, 0), shared::inverseRotation(shared::probeFrame(view.seed, p))))));
      for (size_t c = 0; c < work.transport().size(); ++c)
        for (uint32_t r = 0; r < work.transport()[c].receivers; ++r) {
          const ClusterTransport& t = work.transport()[c];
          double e = 0;
          for (uint32_t i = 0; i < t.columns; ++i) {
            const int j = static_cast<int>(i) % sh64::shCount(order), l = static_cast<int>(std::sqrt(j + 0.5));
            e += static_cast<double>(t.weights[size_t{r} * t.rank + i]) * 2 * static_cast<double>(kPi) * integral[l] * axes[work.clusters().clusters[c].probes[i / sh64::shCount(order)]].c[j];
          }
          ASSERT_NEAR(e, static_cast<double>(kPi) * (1 + std::cos(tilt)) / 2, 5e-3) << "tilt " << tilt << ", order " << order;
          ASSERT_EQ(t.valid[r], 1.0f);
        }
    }
  }
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
