// Surfels against the furnace's closed forms (MEASURES.md, section 1): the exponential average over frames, and the defaults' end.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/scene_file.h"
#include "tests/surfels_harness.h"

namespace hl::test {
namespace {

struct Furnace {
  const char* scene;
  double rho;
  int frames;  ///< after which x (1 - f^n) with a = 0.97 is 1 % short of x (MEASURES.md section 1; 1533 at albedo 0.9)
};
class SurfelFurnace : public ::testing::TestWithParam<Furnace> {
 protected:
  /// Surfels on all walls, which know of no light yet; then the walls begin to shine. An emitter is sampled once: all of them are the same here.
  void cover(SurfelsHarness& h, int side) {
    h.set("direct.samples", "1");
    h.width = h.height = side;
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
  h.set("surfels.max_surfels", "4096").set("surfels.sizing", "world").set("surfels.radius", "0.06").set("surfels.fade_in", "0");
  cover(h, 48);
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

/// Within 1 % of x over the last quarter of twice the frames that an average with a = 0.97 takes to 1 %. (At albedo 0.9 it is there from some 1750 of 3066 on, since a
/// settled cache casts rays in one of four frames.) One parameter is not the default: 8 pixels are a quarter of so small a picture and would be cut at radius_max, of which
/// thousands of surfels cover the walls; in a picture of 360 rows they are a third of the radius here. In this room that makes no difference but the time (albedo 0.5,
/// radius_max at its default: 1.0005 of x with 4700 surfels, 1.0000 with these 840).
TEST_P(SurfelFurnace, DefaultsComeToTheClosedFormAndStay) {
  const Furnace& furnace = GetParam();
  SurfelsHarness h(loadScene(furnace.scene));
  h.set("surfels.radius_max", "0.06");
  cover(h, 32);
  h.shine(emission_);
  const double exact = static_cast<double>(kPi) * furnace.rho / (1 - furnace.rho);
  const int first = furnace.frames * 3 / 2;
  double worst = 0, last = 0;
  int within = 0;
  for (int n = 1; n <= 2 * furnace.frames; ++n) {
    h.frame(inside());
    if (n % 10 != 0 && n != 2 * furnace.frames) continue;
    last = h.mean() / exact - 1;
    within = std::abs(last) < 0.01 ? (within ? within : n) : 0;
    if (n < first) continue;
    worst = std::max(worst, std::abs(last));
    ASSERT_NEAR(last, 0, 0.01) << furnace.scene << " after " << n << " frames";
  }
  std::printf("%s: defaults within 1 %% of x from frame %d on, within %.2f %% from frame %d on, %+.2f %% at %d; %.0f surfels\n", furnace.scene, within, 100 * worst, first,
              100 * last, 2 * furnace.frames, h.counter("surfels"));
  EXPECT_EQ(h.counter("surfel_nan"), 0);
  EXPECT_EQ(h.counter("surfel_inf"), 0);
}

INSTANTIATE_TEST_SUITE_P(Boxes, SurfelFurnace, ::testing::Values(Furnace{"furnace_box_050", 0.5, 305}, Furnace{"furnace_box_080", 0.8, 765}, Furnace{"furnace_box_090", 0.9, 1533}),
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
