// The darkening of gamma-space blending: that it follows from how much a frame's estimates vary, and how much that is in the box with the small emitter.
#include <cmath>
#include <cstdio>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

/// What is left of a mean where its 1/gamma-th power is averaged: E[x^(1/g)]^g / E[x] for x of a Gamma distribution with this sigma / mu.
/// TECHNIQUES.md section 4: 0.90 at 0.5 and 0.65 at 1, with gamma 5.
double expectedFactor(double spread, double gamma) {
  const double k = 1 / (spread * spread);
  return std::exp(gamma * (std::lgamma(k + 1 / gamma) - std::lgamma(k)) - std::log(k));
}

TEST(DdgiGammaLaw, HasTheTablesValues) {
  EXPECT_NEAR(expectedFactor(0.5, 5), 0.90, 0.005);
  EXPECT_NEAR(expectedFactor(1, 5), 0.65, 0.005);
  EXPECT_NEAR(expectedFactor(1e-3, 5), 1, 1e-5);
}

class DdgiGamma : public SessionTest {
 protected:
  /// One bounce, so that frames do not depend on one another.
  Preset oneBounce(const std::string& scene, const char* gamma, const char* rays) {
    Preset preset = smallPreset(scene, "ddgi");
    preset.width = 32, preset.height = 24;
    preset.parameters["ddgi.multi_bounce"] = "false";
    preset.parameters["ddgi.gamma"] = gamma;
    preset.parameters["ddgi.rays"] = rays;
    preset.parameters["ddgi.hysteresis"] = "0.98";
    preset.parameters["direct.samples"] = std::string("1");
    return preset;
  }

  /// Of the settled picture, the same rays and pixels whatever gamma is.
  double meanIrradiance(const std::string& scene, const char* gamma, const char* rays) {
    auto session = makeSession();
    session->load(oneBounce(scene, gamma, rays));
    session->settle();
    expectNoMessages(*session);
    return static_cast<double>(meanOf(session->image("indirect_irradiance")).x);
  }

  static Image atlas(Session& session) {
    for (const DebugView& v : session.technique().debugViews())
      if (v.id == "irradiance_atlas") return session.device().download(v.image);
    ADD_FAILURE() << "no atlas";
    return {};
  }

  struct Darkening {
    double spread = 0;              ///< sigma / mu of a frame's estimates
    double expected = 0;            ///< of the law, from each texel's sigma / mu
    double ofEstimates = 0;         ///< of those estimates themselves: E[x^(1/5)]^5 / E[x]
    double measured = 0;            ///< the atlas with gamma 5 over the mean of the estimates
  };
  /// Over all texels of the probes' maps, weighted by their irradiance, as a picture is: frames without history give the estimates, one by one.
  Darkening darkening(const std::string& scene, const char* rays, int frames = 200) {
    auto session = makeSession();
    Preset preset = oneBounce(scene, "1", rays);
    preset.parameters["ddgi.hysteresis"] = std::string("0");
    session->load(preset);
    std::vector<double> sum, squares, roots;
    for (int n = 0; n < frames; ++n) {
      session->frame();
      const Image a = atlas(*session);
      sum.resize(a.data.size()), squares.resize(a.data.size()), roots.resize(a.data.size());
      for (size_t i = 0; i < a.data.size(); i += 4) {
        const auto x = static_cast<double>(a.data[i]);
        sum[i] += x, squares[i] += x * x, roots[i] += std::pow(x, 0.2);
      }
    }
    session->load(oneBounce(scene, "5", rays));
    session->settle();
    // The average still varies a little: over some of its memories it is what it tends to.
    std::vector<double> known(sum.size());
    constexpr int kTaken = 4;
    for (int n = 0; n < kTaken * 25; ++n) {
      session->frame();
      if (n % 25 != 0) continue;
      const Image a = atlas(*session);
      for (size_t i = 0; i < a.data.size(); i += 4) known[i] += std::pow(static_cast<double>(a.data[i]), 5.0) / kTaken;
    }
    expectNoMessages(*session);
    Darkening d;
    double all = 0;
    for (size_t i = 0; i < sum.size(); i += 4) {
      const double mean = sum[i] / frames;
      if (!(mean > 0)) continue;  // tiles of probes that are asked by nobody
      const double spread = std::sqrt(std::max(0.0, squares[i] / frames - mean * mean)) / mean;
      all += mean;
      d.spread += mean * spread;
      d.expected += mean * expectedFactor(std::max(spread, 1e-3), 5);
      d.ofEstimates += std::pow(roots[i] / frames, 5.0);
      d.measured += known[i];
    }
    for (double* v : {&d.spread, &d.expected, &d.ofEstimates, &d.measured}) *v /= all;
    std::printf("%s rays: sigma / mu %.3f; left of the light: %.4f by the law, %.4f of the estimates, %.4f measured\n", rays, d.spread, d.expected, d.ofEstimates,
                d.measured);
    return d;
  }

  /// The box with its lamp 0.1 m from a wall: the same lamp, the same flux, but much of it lands on a patch that few rays find.
  std::string lampByTheWall() const {
    return folder.write("by_the_wall.json", R"({"version": 1, "shapes": [
      {"type": "box", "material": "wall", "min": [-2, 0, -2], "max": [2, 4, 2], "facing": "inward", "faces": ["-x", "+x", "-y", "-z", "+z"]},
      {"type": "quad", "material": "lamp", "corners": [[-0.05, 4, -1.9], [0.05, 4, -1.9], [0.05, 4, -1.8], [-0.05, 4, -1.8]]},
      {"type": "quad", "material": "wall", "corners": [[-2, 4, -2], [2, 4, -2], [0.05, 4, -1.9], [-0.05, 4, -1.9]]},
      {"type": "quad", "material": "wall", "corners": [[2, 4, -2], [2, 4, 2], [0.05, 4, -1.8], [0.05, 4, -1.9]]},
      {"type": "quad", "material": "wall", "corners": [[2, 4, 2], [-2, 4, 2], [-0.05, 4, -1.8], [0.05, 4, -1.8]]},
      {"type": "quad", "material": "wall", "corners": [[-2, 4, 2], [-2, 4, -2], [-0.05, 4, -1.9], [-0.05, 4, -1.8]]}],
      "materials": {"wall": {"albedo": 0.5}, "lamp": {"albedo": 0.5, "emission": 318309.886}},
      "cameras": [{"name": "inside", "position": [0.6, 1.7, 1.9], "target": [-0.2, 1.7, -2], "vertical_fov_degrees": 75}]})");
  }
};

/// The lamp is small, but it is sampled at every hit, and what it lights is the whole room: a frame's estimates vary by an eighth, whatever its size. What that
/// leaves of the light is what the law says.
TEST_F(DdgiGamma, DarkensTheSmallEmittersBoxByWhatTheLawSays) {
  const std::string scene = "small_emitter_box";
  const double few = meanIrradiance(scene, "1", "16"), many = meanIrradiance(scene, "1", "256"), usual = meanIrradiance(scene, "5", "16");
  std::printf("small emitter: %.4f of the light of 256 rays with 16 and gamma 1, %.4f with 16 and gamma 5\n", few / many, usual / many);
  EXPECT_NEAR(few, many, 0.005 * many);
  EXPECT_LT(usual, 0.985 * many);
  const Darkening d = darkening(scene, "16");
  EXPECT_GT(d.spread, 0.1);
  EXPECT_LT(d.measured, 0.995);
  EXPECT_NEAR(d.measured, d.ofEstimates, 0.002);
  EXPECT_NEAR(1 - d.measured, 1 - d.expected, 0.3 * (1 - d.expected));
}

/// Where few rays find what is lit, estimates are now and then large and else small. The law is of a Gamma distribution, and such ones lose less than it says
/// for their sigma / mu; of the estimates themselves the loss follows all the same.
TEST_F(DdgiGamma, DarkensMoreWhereLessIsLit) {
  const double few = meanIrradiance(lampByTheWall(), "1", "16"), usual = meanIrradiance(lampByTheWall(), "5", "16");
  std::printf("lamp by the wall: gamma 5 leaves %.4f of what gamma 1 does\n", usual / few);
  const Darkening d = darkening(lampByTheWall(), "16");
  EXPECT_GT(d.spread, 0.5);
  EXPECT_NEAR(d.measured, d.ofEstimates, 0.01);
  EXPECT_GT(d.measured, d.expected);
  EXPECT_LT(usual, 0.92 * few);
}

}  // namespace
}  // namespace hl::test
