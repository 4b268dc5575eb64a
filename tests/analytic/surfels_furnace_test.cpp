// Surfels against the furnace's closed forms (MEASURES.md, section 1): the exponential average over frames, and the default estimator's end.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/scene_file.h"
#include "tests/surfels_harness.h"

namespace hl::test {
namespace {

struct Furnace {
  const char* scene;
  double rho;
};
class SurfelFurnace : public ::testing::TestWithParam<Furnace> {
 protected:
  /// Surfels on all walls, which know of no light yet; then the walls begin to shine.
  void cover(SurfelsHarness& h) {
    h.set("surfels.max_surfels", "4096").set("surfels.sizing", "world").set("surfels.radius", "0.06").set("surfels.place_chance", "1").set("surfels.fade_in", "0");
    h.width = h.height = 48;
    emission_ = h.scene.materials.front().emission.x;
    for (Material& m : h.scene.materials) m.emission = vec3(0.0f);
    h.rebuild();
    h.turn(vec3(0.1f, 1.0f, 0.05f), 20);
    EXPECT_EQ(h.mean(), 0);
  }
  float emission_ = 1;
  Camera inside() const {
    Camera c;
    c.position = vec3(0.2f, 1.1f, 0.9f), c.target = vec3(-0.1f, 0.9f, -1);
    c.verticalFov = 1.4f;
    return c;
  }
};

TEST_P(SurfelFurnace, EmaFollowsTheGeometricSeries) {
  // Emission 1: E = x (1 - f^n) after n frames, f = 1 - (1 - a)(1 - rho), x = pi rho / (1 - rho).
  const Furnace& furnace = GetParam();
  SurfelsHarness h(loadScene(furnace.scene));
  const double a = 0.9;
  h.set("surfels.estimator", "ema").set("surfels.hysteresis", "0.9").set("surfels.change_samples", "0").set("surfels.ray_budget", "8");
  cover(h);
  h.shine(emission_);
  const double f = 1 - (1 - a) * (1 - furnace.rho), exact = static_cast<double>(kPi) * furnace.rho / (1 - furnace.rho);
  const int end = static_cast<int>(std::ceil(std::log(0.01) / std::log(f)));
  double worst = 0;
  int next = 1;
  for (int n = 1; n <= end; ++n) {
    h.frame(inside());
    if (n < next && n != end) continue;
    next = std::max(n + 1, n * 5 / 4);
    const double expected = exact * (1 - std::pow(f, n)), relative = h.mean() / expected - 1;
    worst = std::max(worst, std::abs(relative));
    EXPECT_NEAR(relative, 0, 0.01) << furnace.scene << " after " << n << " frames";
  }
  std::printf("%s: ema within %.4f of x (1 - f^n) over %d frames; %.0f surfels, %.0f uncovered hits in the last\n", furnace.scene, worst, end, h.counter("surfels"),
              h.counter("uncovered_hits_last_frame"));
  EXPECT_EQ(h.counter("surfel_nan"), 0);
  EXPECT_EQ(h.counter("surfel_inf"), 0);
}

TEST_P(SurfelFurnace, DefaultsReachTheClosedForm) {
  const Furnace& furnace = GetParam();
  SurfelsHarness h(loadScene(furnace.scene));
  cover(h);
  h.shine(emission_);
  const double exact = static_cast<double>(kPi) * furnace.rho / (1 - furnace.rho);
  int within = 0;
  // Well within twice the frames of an average with a = 0.97 (305, 765, 1533), though it casts a quarter of the rays from frame 256 on.
  const int frames = furnace.rho < 0.6 ? 100 : furnace.rho < 0.85 ? 300 : 2000;
  for (int n = 1; n <= frames; ++n) {
    h.frame(inside());
    if (n % 10 == 0) within = std::abs(h.mean() / exact - 1) < 0.01 ? (within ? within : n) : 0;
  }
  std::printf("%s: %.5f of the closed form after %d frames, within 1 %% from frame %d on\n", furnace.scene, h.mean() / exact, frames, within);
  EXPECT_NEAR(h.mean() / exact, 1, 0.01);
  EXPECT_EQ(h.counter("surfel_nan"), 0);
}

INSTANTIATE_TEST_SUITE_P(Boxes, SurfelFurnace, ::testing::Values(Furnace{"furnace_box_050", 0.5}, Furnace{"furnace_box_080", 0.8}, Furnace{"furnace_box_090", 0.9}),
                         [](const auto& test) { return std::string(test.param.scene); });

TEST(SurfelSphere, IndirectLightIsUniform) {
  // Indirect irradiance in a closed sphere is rho Phi / (A (1 - rho)) everywhere: blind to no wrong ray distribution, as the furnace is.
  SurfelsHarness h(loadScene("light_sphere_080"));
  h.set("surfels.max_surfels", "4096").set("surfels.sizing", "world").set("surfels.radius", "0.05").set("surfels.place_chance", "1").set("surfels.ray_budget", "2");
  h.width = h.height = 48;
  h.rebuild();
  double area = 0;
  for (const uvec3& t : h.scene.indices)
    area += 0.5 * static_cast<double>(glm::length(glm::cross(h.scene.positions[t.y] - h.scene.positions[t.x], h.scene.positions[t.z] - h.scene.positions[t.x])));
  const vec3 centre = h.scene.bounds.centre();
  h.turn(centre, 60);
  const double exact = 0.8 * 4 * static_cast<double>(kPi) * static_cast<double>(h.scene.pointLights[0].intensity.y) / (area * 0.2);
  std::printf("sphere: mean / exact = %.5f\n", h.mean() / exact);
  EXPECT_NEAR(h.mean() / exact, 1, 0.01);
}

}  // namespace
}  // namespace hl::test
