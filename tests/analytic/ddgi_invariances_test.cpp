// What the result must not depend on, and what must balance (MEASURES.md section 1), as far as tests over all techniques do not ask for it.
#include <fmt/core.h>

#include <cstdio>

#include "tests/session_fixture.h"
#include "tests/invariances.h"

namespace hl::test {
namespace {

class DdgiInvariances : public SessionTest {
 protected:
  Preset preset(const std::string& scene, uint32_t seed = 1) {
    Preset p = smallPreset(scene, "ddgi");
    p.seed = seed;
    return p;
  }
};

/// Punctual lights take no random numbers, and averaging is linear: the sum to rounding.
TEST_F(DdgiInvariances, TwoLightsGiveTheSum) {
  auto session = makeSession();
  const auto lit = [&](const std::string& by) {
    return settledIndirect(*session, preset(litRoom(folder, by)));
  };
  const Image one = lit(kTwoLights[0]), two = lit(kTwoLights[1]), both = lit(fmt::format("{}, {}", kTwoLights[0], kTwoLights[1]));
  for (size_t i = 0; i < both.data.size(); ++i) ASSERT_NEAR(both.data[i], one.data[i] + two.data[i], 1e-4f * both.data[i]);
  EXPECT_GT(meanOf(one).x, 0.1f);
  EXPECT_GT(meanOf(two).z, 0.1f);
}

/// The lattice turns with the room where axes go to axes: the same picture within sampling error. The probes' maps have a pole, along z: a turn that moves
/// it shows what six texels leave out, here as much again.
TEST_F(DdgiInvariances, TurnedAndMirroredRoomsLookTheSame) {
  const Turn turns[] = {{"as_it_is", mat3(1), false, false},
                        {"mirrored_x", mat3(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)), true, false},
                        {"mirrored_z", mat3(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1)), true, false},
                        {"half_a_turn", mat3(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1)), false, false},
                        {"a_quarter_about_y", mat3(vec3(0, 0, -1), vec3(0, 1, 0), vec3(1, 0, 0)), false, true},
                        {"a_quarter_about_z", mat3(vec3(0, 1, 0), vec3(-1, 0, 0), vec3(0, 0, 1)), false, false}};
  auto session = makeSession();
  const Image original = settledIndirect(*session, preset(turnedRoom(folder, turns[0])));
  const double noise = rms(original, settledIndirect(*session, preset(turnedRoom(folder, turns[0]), 2))), mean = static_cast<double>(meanOf(original).y);
  for (const Turn& turn : turns) {
    if (&turn == &turns[0]) continue;
    const Image turned = settledIndirect(*session, preset(turnedRoom(folder, turn), 3));
    const double off = rms(original, turned, turn.mirrors);
    std::printf("%s: differs by %.4f of the mean, two seeds by %.4f; mean %+.3f %%\n", turn.name, off / mean, noise / mean,
                100 * (static_cast<double>(meanOf(turned).y) / mean - 1));
    EXPECT_LE(off, (turn.movesPole ? 3 : 1.5) * noise) << turn.name;
    EXPECT_NEAR(static_cast<double>(meanOf(turned).y), mean, 0.01 * mean) << turn.name;
  }
  EXPECT_LT(noise, 0.05 * mean);
}

/// Whatever shines, and wherever: what walls absorb of the indirect light, sum A (1 - rho) E, is what they reflected of the direct light, and that is
/// sum A rho E. A camera with a square picture of 90 degrees at the centre of a cube sees one face, each part of it in as many pixels as any other.
TEST_F(DdgiInvariances, WhatIsReflectedIsAbsorbed) {
  auto session = makeSession();
  Preset p = preset(unevenCube(folder));
  p.width = p.height = 48;
  p.parameters["ddgi.spacing"] = "0.125";
  session->load(p);
  session->settle();
  expectReflectedIsAbsorbed(balanceIn(*session, 1), 0.03);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
