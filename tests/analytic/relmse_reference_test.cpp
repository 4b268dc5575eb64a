// The relative error against a path-traced reference of few paths: of the size that a long one says, where the noise below the line would say anything.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/session_fixture.h"

namespace hl {
namespace {

constexpr int kSeeds = 4;

double relmse(Session& session, const std::string& samples, int seed) {
  session.setParam("reference.samples", samples);
  session.setParam("reference.seed", std::to_string(seed));
  session.reference();
  for (const ErrorValue& e : session.measureErrors({"relmse"}))
    if (e.reference == "matched" && e.component == "indirect" && e.roi.empty()) return e.value;
  throw std::logic_error("there is no such value");
}

/// As it would be with the mean image below the line.
double uncalmed(Session& session) {
  const ReferenceImage r = session.currentReference()->indirectImage(session.transport().bounces);
  const Image v = session.image("indirect_irradiance");
  const double e = measure("relmse", v, r).epsilon;  // of the whole picture, as good as that of its surfaces
  double sum = 0, count = 0;
  for (size_t i = 0; i < v.data.size(); ++i) {
    const size_t pixel = i / 3 * 3;
    if (r.mean.data[pixel] + r.mean.data[pixel + 1] + r.mean.data[pixel + 2] == 0) continue;
    const double mean = static_cast<double>(r.mean.data[i]);
    sum += static_cast<double>((v.data[i] - r.halfA.data[i]) * (v.data[i] - r.halfB.data[i])) / (mean * mean + e * e), ++count;
  }
  return sum / count;
}

class RelmseOfFewPaths : public test::SessionTest {};

TEST_F(RelmseOfFewPaths, HasTheSizeOfThatOfMany) {
  Preset preset = test::smallPreset("cornell_box", "radiosity");
  preset.width = 80, preset.height = 45;
  preset.parameters["lightmap.resolution"] = "48", preset.parameters["radiosity.samples"] = "32";
  auto session = makeSession();
  session->load(preset);
  session->settle();
  const double truth = relmse(*session, "1024", 1);
  std::printf("1024 paths: %.5f (noisy below the line: %.5f)\n", truth, uncalmed(*session));
  for (const char* samples : {"64", "256"}) {
    double sum = 0, squares = 0, noisy = 0;
    for (int seed = 2; seed < 2 + kSeeds; ++seed) {
      const double value = relmse(*session, samples, seed);
      sum += value, squares += value * value;
      noisy += uncalmed(*session) / kSeeds;
    }
    const double mean = sum / kSeeds, error = std::sqrt(std::max(squares / kSeeds - mean * mean, 0.0) / (kSeeds - 1));
    std::printf("%4s paths: %.5f +- %.5f (noisy below the line: %.5f)\n", samples, mean, error, noisy);
    // A coarse lightmap's errors sit at edges that the value has in the wrong place: the hardest case, where the neighbours know the least.
    EXPECT_GT(mean, 0.4 * truth - 3 * error) << samples;
    EXPECT_LT(mean, 1.2 * truth + 3 * error) << samples;
    if (std::string(samples) == "64") {
      EXPECT_GT(noisy, 3 * truth);
    }
  }
}

}  // namespace
}  // namespace hl
