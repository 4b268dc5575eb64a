// Probes that follow: after lights, geometry or the camera have changed they carry on, and come to what a fresh start gives.
#include <cmath>
#include <cstdio>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class DdgiFollow : public SessionTest {
 protected:
  /// Root mean square of the difference.
  static double rms(const Image& a, const Image& b) {
    double sum = 0;
    for (size_t i = 0; i < a.data.size(); ++i) {
      const double d = static_cast<double>(a.data[i]) - static_cast<double>(b.data[i]);
      sum += d * d;
    }
    return std::sqrt(sum / static_cast<double>(a.data.size()));
  }
  static Preset dynamic(const std::string& scene, const char* camera) {
    Preset p;
    p.scene = scene;
    p.technique = "ddgi";
    p.cameraName = camera;
    p.width = 48, p.height = 36;
    p.parameters = {{"ddgi.rays", "64"}, {"ddgi.hysteresis", "0.9"}, {"ddgi.distance_texels", "8"}, {"direct.samples", "1"}};
    return p;
  }
  static Image settled(Session& session) {
    session.settle();
    return session.image("indirect_irradiance");
  }

  /// An object's move from the scene's first moment to `time`: followed, and started anew there.
  void followsTheMove(const Preset& preset, float time) {
    auto session = makeSession();
    session->load(preset);
    const Image before = settled(*session);
    Playback there = preset.animation;
    there.start = time;
    session->setPlayback(there);
    EXPECT_GT(session->frame()->frame, 10u) << "probes were reset";
    const Image followed = settled(*session);
    Preset fresh = preset;
    fresh.animation.start = time;
    session->load(fresh);
    const Image anew = settled(*session);
    fresh.seed = preset.seed + 1;
    session->load(fresh);
    const double noise = rms(anew, settled(*session)), step = rms(before, anew), left = rms(followed, anew);
    std::printf("%s: the move changes %.4g, %.4g is left after following it; two fresh starts differ by %.4g\n", preset.scene.c_str(), step, left, noise);
    // Settled is 1 % of the transient left.
    EXPECT_LE(left, 1.5 * noise + 0.02 * step);
    EXPECT_GT(step, 2 * (1.5 * noise + 0.02 * step));
    expectNoMessages(*session);
  }
};

/// In a sphere with a lamp at its centre every point is lit alike, so that one number says it all: f^n of the step is left after n frames.
TEST_F(DdgiFollow, ALightStepLeavesTheFurnacesLaw) {
  for (const auto& [rho, hysteresis, frames] : {std::tuple{0.5, 0.9, 40}, {0.8, 0.9, 80}, {0.9, 0.8, 80}}) {
    const std::string scene = folder.write("sphere.json", R"({"version": 1, "shapes": [{"type": "icosphere", "material": "wall", "centre": [0, 0, 0],
      "radius": 1, "subdivisions": 6, "facing": "inward"}], "materials": {"wall": {"albedo": )" + std::to_string(rho) + R"(}},
      "lights": [{"type": "point", "name": "lamp", "position": [0, 0, 0], "intensity": 1}],
      "cameras": [{"name": "in", "position": [0.3, 0.1, 0.8], "target": [0, 0, 0], "vertical_fov_degrees": 80}]})");
    auto session = makeSession();
    Preset preset = smallPreset(scene, "ddgi");
    preset.width = 16, preset.height = 12;
    preset.parameters["ddgi.spacing"] = "0.15";  // coarser, and probes outside the sphere take 2 % of its light
    preset.parameters["ddgi.rays"] = "32";
    preset.parameters["ddgi.hysteresis"] = std::to_string(hysteresis);
    session->load(preset);
    const auto settledFrame = session->settle();
    const double before = static_cast<double>(meanOf(session->image("indirect_irradiance")).x), share = 0.25;
    std::vector<PointLight> lamp = session->scene().pointLights;
    lamp.front().intensity *= static_cast<float>(share);
    session->setLights(lamp, {}, {}, session->scene().sky);
    const double f = 1 - (1 - hysteresis) * (1 - rho);
    double worst = 0;
    for (int n = 1; n <= frames; ++n) {
      const auto frame = session->frame();
      ASSERT_EQ(frame->frame, settledFrame->frame + static_cast<uint32_t>(n)) << "the step reset the probes";
      if (n > 8 && n % 8 != 0) continue;
      const double left = (static_cast<double>(meanOf(session->image("indirect_irradiance")).x) / before - share) / (1 - share);
      worst = std::max(worst, std::abs(left - std::pow(f, n)));
      ASSERT_NEAR(left, std::pow(f, n), 0.01) << "albedo " << rho << ", frame " << n;
    }
    std::printf("albedo %.1f, hysteresis %.2f: what is left of the step within %.4f of f^n over %d frames\n", rho, hysteresis, worst, frames);
    expectNoMessages(*session);
  }
}

TEST_F(DdgiFollow, ATurningBlock) {
  Preset preset = dynamic("cornell_spin", "blocks");
  preset.parameters["ddgi.spacing"] = "0.18";
  preset.parameters["ddgi.rays"] = "128";
  followsTheMove(preset, 0.5f);
}

TEST_F(DdgiFollow, ADoorThatOpens) { followsTheMove(dynamic("two_rooms", "dark"), 1.5f); }

/// Probes ask nothing of the camera: the first frame after a cut is as good as a fresh start that has settled there.
TEST_F(DdgiFollow, ACut) {
  auto session = makeSession();
  Preset preset = dynamic("two_rooms", "dark");
  preset.animation.start = 1.5f;
  session->load(preset);
  session->settle();
  session->setCameraName("lit");
  session->frame();
  const Image after = session->image("indirect_irradiance");
  preset.cameraName = "lit";
  session->load(preset);
  const Image anew = settled(*session);
  preset.seed = 2;
  session->load(preset);
  const double noise = rms(anew, settled(*session)), left = rms(after, anew);
  std::printf("cut: differs by %.4g from a fresh start, two of which differ by %.4g\n", left, noise);
  EXPECT_LE(left, 1.5 * noise);
  EXPECT_LT(noise, 0.1 * static_cast<double>(meanOf(anew).y));
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
