// Directional receivers of srp: what a tilted normal receives, against the reference that tilts it too.
#include <cmath>
#include <cstdlib>

#include "engine/techniques/srp/directional.h"
#include "tests/session_fixture.h"

namespace hl::test {
namespace {

/// Irradiance of a normal tilted by `tilt` towards azimuth 0, from unit radiance of `sky(direction)`, by the table and exactly.
template <typename Sky>
std::pair<double, double> tilted(double tilt, const Sky& sky) {
  const std::vector<vec2> table = directionalTable();
  const double nx = std::sin(tilt), nz = std::cos(tilt), pi = static_cast<double>(kPi);
  constexpr int kRings = 200, kSteps = 400;
  double fitted = 0, exact = 0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double z = (i + 0.5) / kRings, s = std::sqrt(1 - z * z), phi = 2 * pi * (j + 0.5) / kSteps, solid = 2 * pi / kRings / kSteps;
      const double radiance = sky(s * std::cos(phi), s * std::sin(phi), z) * solid;
      const double at = z * (kDirectionalEntries - 1);
      const size_t low = std::min<size_t>(static_cast<size_t>(at), kDirectionalEntries - 2);
      const double f = at - static_cast<double>(low);
      const double along = (1 - f) * static_cast<double>(table[low].x) + f * static_cast<double>(table[low + 1].x);
      const double up = (1 - f) * static_cast<double>(table[low].y) + f * static_cast<double>(table[low + 1].y);
      fitted += radiance * (z + along * std::cos(phi) * nx + up * (nz - 1));
      exact += radiance * std::max(0.0, nx * s * std::cos(phi) + nz * z);
    }
  return {fitted, exact};
}

TEST(SrpDirectional, TheTableIsNearTheTruthForBroadLightAndExactUpright) {
  const auto uniform = [](double, double, double) { return 1.0; };
  const auto fromOneSide = [](double x, double, double) { return x > 0 ? 1.0 : 0.0; };
  const auto high = [](double, double, double z) { return z > 0.9 ? 1.0 : 0.0; };
  for (const double tilt : {0.0, 0.3, 0.6, 0.9}) {
    // A uniform hemisphere: pi (1 + cos tilt) / 2.
    const auto [fitted, exact] = tilted(tilt, uniform);
    EXPECT_NEAR(exact, static_cast<double>(kPi) * (1 + std::cos(tilt)) / 2, 2e-3);
    EXPECT_NEAR(fitted, exact, (tilt == 0 ? 1e-6 : 0.01) * exact) << tilt;
    const auto [side, sideExact] = tilted(tilt, fromOneSide);
    EXPECT_NEAR(side, sideExact, (tilt == 0 ? 1e-6 : 0.04) * sideExact) << tilt;
    if (tilt > 0.6) continue;  // light from above that no tilt so far turns away from is linear in the normal
    const auto [above, aboveExact] = tilted(tilt, high);
    EXPECT_NEAR(above, aboveExact, 1e-3 * aboveExact) << tilt;
  }
}

class DirectionalReceivers : public SessionTest {
 protected:
  /// A closed room with a lamp; its floor's vertex normals lean by 35 degrees, towards the red wall and a little towards the viewer.
  std::string room() {
    folder.write("room.mtl", "newmtl white\nKd 0.6 0.6 0.6\nnewmtl red\nKd 0.7 0.1 0.1\n");
    return folder.write("tilted.json", [&] {
      folder.write("room.obj", R"(mtllib room.mtl
v -1 -1 -1
v 1 -1 -1
v 1 -1 1
v -1 -1 1
v -1 1 -1
v 1 1 -1
v 1 1 1
v -1 1 1
vn -0.526 0.819152 0.2287
vn 0 -1 0
vn 1 0 0
vn -1 0 0
vn 0 0 1
vn 0 0 -1
usemtl white
f 1//1 4//1 3//1 2//1
f 5//2 6//2 7//2 8//2
f 2//4 3//4 7//4 6//4
f 1//5 2//5 6//5 5//5
f 4//6 8//6 7//6 3//6
usemtl red
f 1//3 5//3 8//3 4//3
)");
      return R"({"version": 1, "mesh": {"file": "room.obj"}, "lights": [{"type": "point", "name": "lamp", "position": [0.6, 0.5, 0.1], "intensity": 5}],
        "cameras": [{"name": "floor", "position": [0.1, 0.9, 0.1], "target": [-0.1, -1, -0.1], "vertical_fov_degrees": 60}]})";
    }());
  }
  double error(Session& session, const std::string& metric, const std::string& reference) {
    for (const ErrorValue& e : session.measureErrors({metric}))
      if (e.reference == reference && e.component == "indirect" && e.roi.empty()) return e.value;
    return NAN;
  }
};

TEST_F(DirectionalReceivers, ATiltedNormalGetsWhatTheReferenceGivesIt) {
  const std::string scene = room();
  double bias[2], relmse[2];
  for (const bool directional : {false, true}) {
    auto session = makeSession();
    Preset p = smallPreset(scene, "srp");
    p.parameters["srp.receivers"] = directional ? "directional" : "irradiance";
    p.parameters["reference.samples"] = "128";
    session->load(p);
    session->settle();
    session->reference();
    // The full reference tilts normals wherever light is received; the floor is the only tilted surface and the red wall's light comes from all others, so the two references
    // are near each other, and the difference between the receivers is that of their last step.
    bias[directional] = error(*session, "bias", "full"), relmse[directional] = error(*session, "relmse", "full");
    std::printf("%s: against its matched reference bias %.4f, relmse %.4f\n", directional ? "directional" : "irradiance", error(*session, "bias", "matched"), error(*session, "relmse", "matched"));
    if (directional) {
      EXPECT_EQ(session->transport().receiver, ReceiverNormal::MappedAtReceiver);
      // 1.2 % is the lightmap's, as with the surface's own normal; the rest is what a straight line leaves of light that a normal of the cone turns away from.
      EXPECT_LT(std::abs(error(*session, "bias", "matched")), 0.05);
      EXPECT_LT(error(*session, "relmse", "matched"), 0.015);
    }
    expectNoMessages(*session);
  }
  std::printf("floor with normals leaning by 35 degrees: bias %.4f relmse %.4f with the surface's normal, %.4f %.4f directional\n", bias[0], relmse[0], bias[1], relmse[1]);
  EXPECT_LT(relmse[1], 0.25 * relmse[0]);
}

TEST_F(DirectionalReceivers, ABallOfFacetsIsLitAsASmoothOne) {
  if (!std::getenv("HALFLIGHT_SCENES")) GTEST_SKIP() << "HALFLIGHT_SCENES is not set: the Cornell box's ball is not looked for";
  // Each facet's receivers have normals of their own; the pixels' are smooth. Its facets are small, so that either is near: this holds curved charts to the reference, no more.
  double rmse[2];  // relmse there is decided by black pixels where the ball meets the floor
  for (const bool directional : {false, true}) {
    auto session = makeSession();
    Preset p = smallPreset("cornell_sphere", "srp");
    p.parameters["lightmap.resolution"] = "96";
    p.parameters["srp.receivers"] = directional ? "directional" : "irradiance";
    p.parameters["srp.compression"] = "none";
    session->load(p);
    session->settle();
    session->reference();
    rmse[directional] = error(*session, "rmse", "full");
    if (directional) {
      EXPECT_LT(std::abs(error(*session, "bias", "matched")), 0.03);
    }
    expectNoMessages(*session);
  }
  std::printf("cornell_sphere: rmse %.5f with the surface's normal, %.5f directional\n", rmse[0], rmse[1]);
  EXPECT_LT(rmse[1], 1.01 * rmse[0]);
}

TEST_F(DirectionalReceivers, WithFlatNormalsNothingChanges) {
  // Where the mapped normal is the surface's own, both kinds of receivers show the same picture; compression apart, whose vectors have more rows to serve.
  Image images[2];
  for (const bool directional : {false, true}) {
    auto session = makeSession();
    Preset p = quickPreset("point_light_cube", "srp");  // plane to the last bit, which the Cornell box's quads are not
    p.parameters["srp.compression"] = "none";
    p.parameters["srp.receivers"] = directional ? "directional" : "irradiance";
    session->load(p);
    session->settle();
    expectNoMessages(*session);
    images[directional] = session->image("indirect_irradiance");
  }
  for (size_t i = 0; i < images[0].data.size(); ++i) ASSERT_NEAR(images[1].data[i], images[0].data[i], 1e-4f * std::abs(images[0].data[i]) + 1e-5f);
}

}  // namespace
}  // namespace hl::test
