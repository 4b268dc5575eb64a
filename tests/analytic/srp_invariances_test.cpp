// What srp's result must not depend on, and what must balance (MEASURES.md section 1), as far as tests over all techniques do not ask for it.
#include <fmt/core.h>

#include <cmath>
#include <cstdio>

#include "tests/invariances.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

class SrpInvariances : public SessionTest {
 protected:
  static Preset preset(const std::string& scene, uint32_t seed = 1, const char* rays = "128") {
    Preset p = smallPreset(scene, "srp");
    p.seed = seed;
    p.width = 32, p.height = 24;
    p.parameters["srp.cache"] = "false", p.parameters["srp.compression"] = "none", p.parameters["srp.receiver_rays"] = rays, p.parameters["srp.probe_rays"] = "1024";
    return p;
  }
};

/// The grid of probes turns with the room where axes go to axes; their rays and the receivers' do not, nor do charts of the lightmap.
TEST_F(SrpInvariances, TurnedAndMirroredRoomsLookTheSame) {
  const Turn turns[] = {{"mirrored_x", mat3(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)), true, false},
                        {"a_quarter_about_z", mat3(vec3(0, 1, 0), vec3(-1, 0, 0), vec3(0, 0, 1)), false, false}};
  auto session = makeSession();
  const std::string asItIs = turnedRoom(folder, {"as_it_is", mat3(1), false, false});
  const Image original = settledIndirect(*session, preset(asItIs, 1, "256"));
  const double noise = rms(original, settledIndirect(*session, preset(asItIs, 2, "256"))), mean = static_cast<double>(meanOf(original).y);
  for (const Turn& turn : turns) {
    const Image turned = settledIndirect(*session, preset(turnedRoom(folder, turn), 3, "256"));
    const double off = rms(original, turned, turn.mirrors), there = static_cast<double>(meanOf(turned).y);
    std::printf("%s: differs by %.4f of the mean, two seeds by %.4f; mean %+.3f %%\n", turn.name, off / mean, noise / mean, 100 * (there / mean - 1));
    EXPECT_LE(off, 2 * noise) << turn.name;
    EXPECT_NEAR(there, mean, 0.01 * mean) << turn.name;
  }
  EXPECT_LT(noise, 0.05 * mean);
}

TEST_F(SrpInvariances, WhatIsReflectedIsAbsorbed) {
  auto session = makeSession();
  Preset p = preset(unevenCube(folder));
  p.width = p.height = 48;
  session->load(p);
  session->settle();
  expectReflectedIsAbsorbed(balanceIn(*session, 1), 0.02);
  expectNoMessages(*session);
}

/// A box without a lid under a sky, with a lamp in it. Sky and lamp reach receivers as direct light; probes hold what surfaces reflect, and nothing where there is no surface:
/// that is all the indirect light there is, as radiosity on the same lightmap finds it, which has no probes.
TEST_F(SrpInvariances, NothingIsLostUnderAnOpenSky) {
  const std::string scene = folder.write("open.json", R"({"version": 1, "shapes": [
      {"type": "quad", "material": "wall", "corners": [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]]},
      {"type": "quad", "material": "red", "corners": [[-1, 0, -1], [1, 0, -1], [1, 1, -1], [-1, 1, -1]]},
      {"type": "quad", "material": "wall", "corners": [[1, 0, -1], [1, 0, 1], [1, 1, 1], [1, 1, -1]]},
      {"type": "quad", "material": "wall", "corners": [[1, 0, 1], [-1, 0, 1], [-1, 1, 1], [1, 1, 1]]},
      {"type": "quad", "material": "wall", "corners": [[-1, 0, 1], [-1, 0, -1], [-1, 1, -1], [-1, 1, 1]]},
      {"type": "quad", "material": "lamp", "corners": [[0.2, 0.5, 0.2], [0.2, 0.5, 0.5], [0.5, 0.5, 0.5], [0.5, 0.5, 0.2]]}],
    "materials": {"wall": {"albedo": 0.6}, "red": {"albedo": [0.8, 0.2, 0.2]}, "lamp": {"albedo": 0, "emission": [6, 6, 6]}},
    "sky": [1, 1.5, 2],
    "cameras": [{"name": "c", "position": [0, 2.6, 1.2], "target": [0, 0.2, 0], "vertical_fov_degrees": 50}]})");
  auto session = makeSession();
  Preset r = smallPreset(scene, "radiosity");
  r.width = 32, r.height = 24;
  const Image truth = settledIndirect(*session, r);
  const vec3 mean = meanOf(truth);
  EXPECT_GT(mean.z, 0.1f);
  for (const char* order : {"2", "7"}) {
    Preset p = preset(scene);
    p.parameters["srp.sh_order"] = order, p.parameters["probes.spacing"] = "0.2";
    const Image found = settledIndirect(*session, p);
    const vec3 there = meanOf(found);
    std::printf("open box, order %s: mean %+.2f, %+.2f, %+.2f %%, differs by %.4f of the mean\n", order, static_cast<double>(100 * (there.x / mean.x - 1)),
                static_cast<double>(100 * (there.y / mean.y - 1)), static_cast<double>(100 * (there.z / mean.z - 1)), rms(found, truth) / static_cast<double>(mean.y));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], mean[c], 0.03f * mean[c]) << "order " << order;
  }
}

}  // namespace
}  // namespace hl::test
