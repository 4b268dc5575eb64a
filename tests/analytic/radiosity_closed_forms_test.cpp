// Radiosity against closed forms (MEASURES.md, section 1): furnaces, the point-light cube, the sphere.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/scene_file.h"
#include "tests/point_light_cube.h"
#include "tests/technique_harness.h"

namespace hl::test {
namespace {

struct Mean {
  double value = 0, standardError = 0;
};
Mean meanOf(const std::vector<double>& v) {
  Mean m;
  for (double x : v) m.value += x / static_cast<double>(v.size());
  double variance = 0;
  for (double x : v) variance += (x - m.value) * (x - m.value) / static_cast<double>(v.size() - 1);
  m.standardError = std::sqrt(variance / static_cast<double>(v.size()));
  return m;
}

struct Furnace {
  const char* scene;
  double rho;
  int bounces;
};
class FurnaceTest : public ::testing::TestWithParam<Furnace> {};

TEST_P(FurnaceTest, FollowsTheSeriesOfBounces) {
  // Emission 1 everywhere: E = pi (rho + rho^2 + ... + rho^k) after k bounces.
  const Furnace& f = GetParam();
  TechniqueHarness h("radiosity", loadScene(f.scene));
  h.set("lightmap.resolution", "64").set("radiosity.samples", "64").set("radiosity.residual", "0").set("direct.lumel_samples", "1024");
  h.set("radiosity.bounces", std::to_string(f.bounces));
  const std::vector<vec3> e = h.bake();
  double series = 0;
  for (int k = 1; k <= f.bounces; ++k) series += std::pow(f.rho, k);
  const double exact = static_cast<double>(kPi) * series;
  std::vector<double> relative;
  for (const vec3& v : e) relative.push_back(static_cast<double>(v.y) / exact);
  const Mean m = meanOf(relative);
  RecordProperty("mean", std::to_string(m.value));
  std::printf("%s, %d bounces: mean / exact = %.5f, standard error %.5f, %zu lumels\n", f.scene, f.bounces, m.value, m.standardError, e.size());
  EXPECT_LE(m.standardError, 3e-4);
  EXPECT_NEAR(m.value, 1, 1e-3);
  EXPECT_EQ(h.counter("back_face_hits"), 0);
  EXPECT_EQ(h.counter("lightmap_nan_inf"), 0);
}
INSTANTIATE_TEST_SUITE_P(Boxes, FurnaceTest,
                         ::testing::Values(Furnace{"furnace_box_050", 0.5, 7}, Furnace{"furnace_box_080", 0.8, 21}, Furnace{"furnace_box_090", 0.9, 44}),
                         [](const auto& test) { return std::string(test.param.scene); });

TEST(PointLightCube, MatchesAtTheThreeInteriorPoints) {
  for (const char* directions : {"low_discrepancy", "largest_empty_circle"}) {
    TechniqueHarness h("radiosity", loadScene("point_light_cube"));
    h.set("lightmap.resolution", "128").set("radiosity.samples", "512").set("radiosity.bounces", "40").set("radiosity.residual", "1e-6");
    h.set("radiosity.directions", directions);
    const std::vector<vec3> e = h.bake();
    const std::array<double, 3> found = cubeRadiance(h.atlas, e);
    std::printf("point-light cube, %s: %.2f %.2f %.2f (exact %.1f %.1f %.1f)\n", directions, found[0], found[1], found[2], kCubeRadiance[0], kCubeRadiance[1], kCubeRadiance[2]);
    for (size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], kCubeRadiance[i], 0.004 * kCubeRadiance[i]);
  }
}

TEST(LightSphere, IndirectLightIsUniform) {
  TechniqueHarness h("radiosity", loadScene("light_sphere_080"));
  h.set("lightmap.resolution", "96").set("radiosity.samples", "256").set("radiosity.bounces", "64").set("radiosity.residual", "1e-6");
  const std::vector<vec3> e = h.bake();
  const double exact = 0.8 * 4 * static_cast<double>(kPi) / (h.atlas.report.area * 0.2);
  double squares = 0;
  for (const vec3& v : e) squares += std::pow(static_cast<double>(v.y) / exact - 1, 2) / static_cast<double>(e.size());
  const double mean = h.meanLuminance(e) / exact;
  std::printf("sphere: mean / exact = %.5f, rms deviation %.5f, %.0f hits without a texel\n", mean, std::sqrt(squares), h.counter("hits_without_texel"));
  EXPECT_NEAR(mean, 1, 2e-3);
  EXPECT_LT(std::sqrt(squares), 0.01);
}

TEST(ClosedScene, AbsorbsWhatIsEmitted) {
  // Sum of area (1 - rho) E over all surfaces, direct and indirect, is the flux of the lamp.
  TechniqueHarness h("radiosity", loadScene("point_light_cube"));
  h.set("lightmap.resolution", "64").set("radiosity.samples", "256").set("radiosity.bounces", "40").set("radiosity.residual", "1e-6");
  const std::vector<vec3> e = h.bake();
  double absorbed = 0;
  for (size_t i = 0; i < e.size(); ++i) {
    const Lumel& l = h.atlas.lumels[i];
    // Direct light of the point light at the lumel: I cos / r^2.
    const double r2 = glm::dot(glm::dvec3(l.position), glm::dvec3(l.position)), cosine = 5 / std::sqrt(r2);
    absorbed += static_cast<double>(l.area) * (1 - 2.0 / 3) * (static_cast<double>(e[i].y) + 50000 * cosine / r2);
  }
  EXPECT_NEAR(absorbed / (4 * static_cast<double>(kPi) * 50000), 1, 2e-3);
}

}  // namespace
}  // namespace hl::test
