// What surfels' result must not depend on, and what must balance (MEASURES.md section 1), as far as tests over all techniques do not ask for it. Where surfels lie
// is drawn by chance and turns with nothing: the sampling error, which is the bound, comes from several seeds.
#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "tests/invariances.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

constexpr uint32_t kSeeds = 4;
constexpr int kFrames = 48;

class SurfelInvariances : public SessionTest {
 protected:
  static Preset preset(const std::string& scene, uint32_t seed = 1) {
    Preset p = smallPreset(scene, "surfels");
    p.seed = seed;
    p.width = 32, p.height = 24;
    p.parameters.insert_or_assign("surfels.settle_frames", std::to_string(kFrames));
    return p;
  }
};

/// How much results of different seeds differ.
struct Spread {
  double mean = 0;
  double deviation = 0;  ///< of one seed's mean
  double rms = 0;        ///< between two seeds' pictures
};

Spread spreadOf(const std::vector<Image>& images) {
  Spread s;
  std::vector<double> means;
  for (const Image& image : images) means.push_back(static_cast<double>(meanOf(image).y));
  for (const double m : means) s.mean += m / static_cast<double>(means.size());
  for (const double m : means) s.deviation += (m - s.mean) * (m - s.mean) / static_cast<double>(means.size() - 1);
  s.deviation = std::sqrt(s.deviation);
  for (size_t i = 1; i < images.size(); ++i) s.rms += rms(images[0], images[i]) / static_cast<double>(images.size() - 1);
  return s;
}

/// An average that nothing but the number of samples steers is linear in the light, wherever surfels lie: the sum to rounding. The defaults, whose average and
/// whose rays follow inconsistency, within sampling error.
TEST_F(SurfelInvariances, TwoLightsGiveTheSum) {
  auto session = makeSession();
  const auto lit = [&](const std::string& by, bool linear, uint32_t seed) {
    Preset p = preset(litRoom(folder, by), seed);
    if (linear) p.parameters["surfels.estimator"] = "ema", p.parameters["surfels.inconsistency_gain"] = std::to_string(0);
    return settledIndirect(*session, p);
  };
  const std::string together = fmt::format("{}, {}", kTwoLights[0], kTwoLights[1]);
  const Image one = lit(kTwoLights[0], true, 1), two = lit(kTwoLights[1], true, 1), both = lit(together, true, 1);
  for (size_t i = 0; i < both.data.size(); ++i) ASSERT_NEAR(both.data[i], one.data[i] + two.data[i], 1e-4f * both.data[i] + 1e-6f);
  EXPECT_GT(meanOf(one).x, 0.1f);
  EXPECT_GT(meanOf(two).z, 0.1f);
  std::vector<Image> seeds;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) seeds.push_back(lit(together, false, seed));
  const Spread spread = spreadOf(seeds);
  const double sum = static_cast<double>(meanOf(lit(kTwoLights[0], false, 11)).y + meanOf(lit(kTwoLights[1], false, 12)).y);
  std::printf("two lights: sum %+.3f %% off; one seed's mean deviates by %.3f %%\n", 100 * (sum / spread.mean - 1), 100 * spread.deviation / spread.mean);
  EXPECT_NEAR(sum, spread.mean, 5 * spread.deviation);
  EXPECT_LT(spread.deviation, 0.005 * spread.mean);
}

TEST_F(SurfelInvariances, TurnedAndMirroredRoomsLookTheSame) {
  const Turn turns[] = {{"mirrored_x", mat3(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)), true, false},
                        {"a_quarter_about_y", mat3(vec3(0, 0, -1), vec3(0, 1, 0), vec3(1, 0, 0)), false, false},
                        {"a_quarter_about_z", mat3(vec3(0, 1, 0), vec3(-1, 0, 0), vec3(0, 0, 1)), false, false}};
  auto session = makeSession();
  const std::string asItIs = turnedRoom(folder, {"as_it_is", mat3(1), false, false});
  std::vector<Image> seeds;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) seeds.push_back(settledIndirect(*session, preset(asItIs, seed)));
  const Spread spread = spreadOf(seeds);
  for (const Turn& turn : turns) {
    const Image turned = settledIndirect(*session, preset(turnedRoom(folder, turn), 11));
    const double off = rms(seeds[0], turned, turn.mirrors), mean = static_cast<double>(meanOf(turned).y);
    std::printf("%s: differs by %.4f of the mean, two seeds by %.4f; mean %+.3f %%, one seed's deviates by %.3f %%\n", turn.name, off / spread.mean, spread.rms / spread.mean,
                100 * (mean / spread.mean - 1), 100 * spread.deviation / spread.mean);
    EXPECT_LE(off, 1.3 * spread.rms) << turn.name;
    EXPECT_NEAR(mean, spread.mean, 5 * spread.deviation) << turn.name;
  }
  EXPECT_LT(spread.rms, 0.1 * spread.mean);
  EXPECT_LT(spread.deviation, 0.005 * spread.mean);
}

TEST_F(SurfelInvariances, WhatIsReflectedIsAbsorbed) {
  auto session = makeSession();
  Preset p = preset(unevenCube(folder));
  p.width = p.height = 48;
  session->load(p);
  session->settle();
  balanceIn(*session, 16);  // it has looked everywhere
  expectReflectedIsAbsorbed(balanceIn(*session, 16), 0.02);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
