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

/// A mean of 1/gamma-th powers lies below the mean where what is averaged varies: here by what few rays find under the lamp.
TEST_F(SessionTest, GammaDarkensAndLinearBlendingDoesNot) {
  const auto bias = [&](const char* gamma) {
    auto session = makeSession();
    Preset preset = smallPreset("small_emitter_box", "ddgi");
    preset.parameters["ddgi.gamma"] = gamma;
    preset.parameters["ddgi.rays"] = "16";
    preset.parameters["reference.samples"] = "256";
    session->load(preset);
    session->settle();
    session->reference();
    expectNoMessages(*session);
    for (const ErrorValue& e : session->measureErrors({"bias"}))
      if (e.reference == "matched" && e.component == "indirect" && e.roi.empty()) return e.value;
    ADD_FAILURE() << "no bias";
    return 0.0;
  };
  const double linear = bias("1"), usual = bias("5");
  std::printf("small emitter: bias %.2f %% with gamma 1, %.2f %% with gamma 5\n", 100 * linear, 100 * usual);
  EXPECT_LT(std::abs(linear), 0.03);
  EXPECT_LT(usual, linear - 0.03);
}

}  // namespace
}  // namespace hl::test
