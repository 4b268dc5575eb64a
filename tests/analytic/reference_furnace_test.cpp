// Closed scenes of uniform light: the k-bounce series, and energy.
#include <gtest/gtest.h>

#include "tests/analytic/reference_fixture.h"

namespace hl {
namespace {

using namespace hl::test;

constexpr double kE = 3.14159265358979323846;  // irradiance from radiance 1 all round

Scene furnace(float rho, float emission = 1) {
  Scene s;
  addRoom(s, vec3(-1.0f), vec3(1.0f), addMaterial(s, vec3(rho), vec3(emission)));
  return s;
}

class Furnace : public ::testing::TestWithParam<float> {};

// Direct irradiance pi Le; bounce k adds pi Le rho^k; all of them pi Le rho / (1 - rho).
TEST_P(Furnace, EveryBounceAndTheSum) {
  const float rho = GetParam();
  const Scene s = furnace(rho);
  ReferenceSettings settings;
  settings.samplesPerPixel = 4096, settings.directSamples = 1024;
  const auto r = trace(s, receiversOverSurface(s, 128), settings);
  EXPECT_EQ(r->nonFinite, 0u);
  EXPECT_EQ(r->backFaceHits, 0u);
  const Estimate direct = meanOf(r->directImage(), true);
  EXPECT_LE(direct.error, 3e-4 * kE);
  EXPECT_NEAR(direct.value, kE, 1e-3 * kE) << "se " << direct.error;
  double series = 0;
  for (int bounces = 1; bounces <= kBounceBuckets; ++bounces) {
    const Estimate e = meanOf(r->indirectImage(bounces), true);
    const double term = kE * std::pow(static_cast<double>(rho), bounces);
    series = bounces < kBounceBuckets ? series + term : kE * static_cast<double>(rho) / (1 - static_cast<double>(rho));
    EXPECT_LE(e.error, 3e-4 * series) << bounces << " bounces";
    EXPECT_NEAR(e.value, series, 1e-3 * series) << bounces << " bounces, se " << e.error;
    if (bounces == kBounceBuckets) {
      std::printf("rho %.2f: indirect %.5f of %.5f (%+.4f %%), standard error %.4f %%\n", static_cast<double>(rho), e.value,
                  series, 100 * (e.value / series - 1), 100 * e.error / series);
      continue;
    }
    // The term by itself, so that one bounce too many here can't hide behind one too few there.
    const Estimate own = meanOf(bucketOf(*r, static_cast<size_t>(bounces) - 1), true);
    EXPECT_NEAR(own.value, term, std::min(4.5 * own.error, 5e-3 * term)) << "bounce " << bounces;
  }
}

INSTANTIATE_TEST_SUITE_P(Albedos, Furnace, ::testing::Values(0.5f, 0.8f, 0.9f));

}  // namespace
}  // namespace hl
