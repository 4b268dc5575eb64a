// Closed forms: the exponential average in a furnace frame by frame, and the darkening of gamma-space blending.
#include <cmath>
#include <cstdio>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

struct Furnace {
  const char* scene;
  double rho, hysteresis;
  int frames;
};

class DdgiFurnace : public SessionTest, public ::testing::WithParamInterface<Furnace> {};

INSTANTIATE_TEST_SUITE_P(Albedos, DdgiFurnace,
                         ::testing::Values(Furnace{"furnace_box_050", 0.5, 0.97, 120}, Furnace{"furnace_box_080", 0.8, 0.9, 120},
                                           Furnace{"furnace_box_090", 0.9, 0.8, 120}),
                         [](const auto& p) { return std::string(p.param.scene); });

/// x (1 - f^n), f = 1 - (1 - a) (1 - rho), with x the indirect irradiance pi Le rho / (1 - rho).
TEST_P(DdgiFurnace, EmaFollowsItsLaw) {
  const Furnace f = GetParam();
  auto session = makeSession();
  Preset preset = smallPreset(f.scene, "ddgi");
  preset.width = 16, preset.height = 12;
  preset.parameters["ddgi.start"] = "ema";
  preset.parameters["ddgi.hysteresis"] = std::to_string(f.hysteresis);
  preset.parameters["ddgi.spacing"] = "0.5";
  preset.parameters["ddgi.rays"] = "256";
  session->load(preset);
  session->frame();
  const double emission = static_cast<double>(session->scene().materials.front().emission.x);
  const double x = 3.14159265358979 * emission * f.rho / (1 - f.rho), left = 1 - (1 - f.hysteresis) * (1 - f.rho);
  double worst = 0;
  for (int n = 1; n <= f.frames; ++n) {
    if (n > 1) session->frame();
    if (n > 8 && n % 8 != 0) continue;
    const double expected = x * (1 - std::pow(left, n)), mean = static_cast<double>(meanOf(session->image("indirect_irradiance")).x);
    worst = std::max(worst, std::abs(mean / expected - 1));
    ASSERT_NEAR(mean, expected, 0.01 * expected) << "frame " << n;
  }
  std::printf("%s: within %.3f %% of x (1 - f^n) throughout\n", f.scene, 100 * worst);
  expectNoMessages(*session);
}

class DdgiGamma : public SessionTest {
 protected:
  /// Of the settled indirect light against the matched reference.
  double bias(const std::string& scene, const char* gamma, const char* rays) {
    auto session = makeSession();
    Preset preset = smallPreset(scene, "ddgi");
    preset.width = 32, preset.height = 24;
    preset.parameters["ddgi.gamma"] = gamma;
    preset.parameters["ddgi.rays"] = rays;
    preset.parameters["reference.samples"] = "256";
    session->load(preset);
    session->settle();
    session->reference();
    expectNoMessages(*session);
    for (const ErrorValue& e : session->measureErrors({"bias"}))
      if (e.reference == "matched" && e.component == "indirect" && e.roi.empty()) return e.value;
    ADD_FAILURE() << "no bias";
    return 0;
  }
};

/// A mean of 1/gamma-th powers lies below the mean where what is averaged varies: here little, since the lamp itself is sampled at each hit.
TEST_F(DdgiGamma, DarkensTheSmallEmittersBox) {
  const double few = bias("small_emitter_box", "1", "16"), many = bias("small_emitter_box", "1", "256"), usual = bias("small_emitter_box", "5", "16");
  std::printf("small emitter: bias %.2f %% with gamma 1 and 16 rays, %.2f %% with 256; %.2f %% with gamma 5 and 16\n", 100 * few, 100 * many, 100 * usual);
  EXPECT_NEAR(few, many, 0.004);
  EXPECT_LT(usual, few - 0.005);
}

/// A spot light on a patch that few rays find.
TEST_F(DdgiGamma, DarkensABeam) {
  const std::string scene = folder.write("beam.json", R"({"version": 1, "shapes": [
    {"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1], "facing": "inward"}],
    "materials": {"wall": {"albedo": [0.6, 0.6, 0.6]}},
    "lights": [{"type": "spot", "position": [0.5, 0.9, 0.5], "direction": [0, -1, 0], "intensity": [10, 10, 10], "inner_degrees": 6, "outer_degrees": 9}],
    "cameras": [{"name": "c", "position": [-0.8, 0, 0.8], "target": [0.5, -0.2, -0.5], "vertical_fov_degrees": 80}]})");
  const double few = bias(scene, "1", "32"), many = bias(scene, "1", "512"), usual = bias(scene, "5", "32");
  std::printf("beam: bias %.2f %% with gamma 1 and 32 rays, %.2f %% with 512; %.2f %% with gamma 5 and 32\n", 100 * few, 100 * many, 100 * usual);
  EXPECT_NEAR(few, many, 0.06);
  EXPECT_LT(usual, few - 0.1);
}

}  // namespace
}  // namespace hl::test
