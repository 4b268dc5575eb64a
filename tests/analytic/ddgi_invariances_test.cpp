// What the result must not depend on, and what must balance (MEASURES.md section 1), as far as tests over all techniques do not ask for it.
#include <fmt/core.h>

#include <cmath>
#include <cstdio>

#include "tests/session_fixture.h"

namespace hl::test {
namespace {

/// Of a room's points: p -> M p, with rows of M. Boxes stay boxes: rows are axes.
struct Turn {
  const char* name;
  mat3 m;
  bool mirrors, movesPole;
};

class DdgiInvariances : public SessionTest {
 protected:
  Preset preset(const std::string& scene, uint32_t seed = 1) {
    Preset p = smallPreset(scene, "ddgi");
    p.seed = seed;
    return p;
  }
  Image indirect(Session& session, const Preset& p) {
    session.load(p);
    session.settle();
    expectNoMessages(session);
    return session.image("indirect_irradiance");
  }
  static double rms(const Image& a, const Image& b, bool flipped = false) {
    double sum = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x)
        for (int c = 0; c < a.channels; ++c) {
          const double d = static_cast<double>(a.pixel(x, y)[c]) - static_cast<double>(b.pixel(flipped ? a.width - 1 - x : x, y)[c]);
          sum += d * d;
        }
    return std::sqrt(sum / static_cast<double>(a.data.size()));
  }

  /// A room that is no cube, with a block and a lamp that lie to one side.
  std::string turnedRoom(const Turn& turn) {
    const auto text = [](vec3 v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); };
    const auto box = [&](vec3 a, vec3 b) {
      const vec3 p = turn.m * a, q = turn.m * b;
      return fmt::format("\"min\": {}, \"max\": {}", text(glm::min(p, q)), text(glm::max(p, q)));
    };
    std::string corners;
    const vec3 lamp[4] = {{0.2f, 0.78f, -0.3f}, {0.6f, 0.78f, -0.3f}, {0.6f, 0.78f, 0.2f}, {0.2f, 0.78f, 0.2f}};
    for (int i = 0; i < 4; ++i) corners += (i ? ", " : "") + text(turn.m * lamp[turn.mirrors ? 3 - i : i]);
    const vec3 at = turn.m * vec3(-0.8f, 0.2f, 1.1f), to = turn.m * vec3(0.3f, -0.3f, -0.4f), up = turn.m * vec3(0, 1, 0);
    return folder.write(fmt::format("{}.json", turn.name), fmt::format(R"({{"version": 1, "shapes": [
      {{"type": "box", "material": "wall", {}, "facing": "inward"}}, {{"type": "box", "material": "block", {}}},
      {{"type": "quad", "material": "lamp", "corners": [{}]}}],
      "materials": {{"wall": {{"albedo": [0.7, 0.6, 0.5]}}, "block": {{"albedo": [0.2, 0.5, 0.7]}}, "lamp": {{"albedo": 0, "emission": [10, 9, 8]}}}},
      "cameras": [{{"name": "c", "position": {}, "target": {}, "up": {}, "vertical_fov_degrees": 75}}]}})",
                                                          box({-1, -0.8f, -1.2f}, {1, 0.8f, 1.2f}), box({-0.7f, -0.8f, -0.9f}, {-0.1f, 0.1f, -0.2f}), corners, text(at),
                                                          text(to), text(up)));
  }
};

/// Punctual lights take no random numbers, and averaging is linear: the sum to rounding.
TEST_F(DdgiInvariances, TwoLightsGiveTheSum) {
  const char* const lights[] = {R"({"type": "point", "position": [0.6, 0.7, 0.2], "intensity": [3, 2, 1]})",
                                R"({"type": "spot", "position": [-0.7, 0.5, 0.6], "direction": [1, -0.6, -0.5], "intensity": [1, 4, 9], "inner_degrees": 20, "outer_degrees": 35})"};
  auto session = makeSession();
  const auto lit = [&](const std::string& by) {
    return indirect(*session, preset(folder.write("lit.json", R"({"version": 1, "shapes": [{"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1],
      "facing": "inward"}, {"type": "box", "material": "wall", "min": [-0.4, -1, -0.5], "max": [0.2, -0.3, 0]}], "materials": {"wall": {"albedo": [0.7, 0.5, 0.3]}},
      "cameras": [{"name": "c", "position": [0.8, 0.1, 0.9], "target": [-0.3, -0.4, -0.3], "vertical_fov_degrees": 75}], "lights": [)" + by + "]}")));
  };
  const Image one = lit(lights[0]), two = lit(lights[1]), both = lit(fmt::format("{}, {}", lights[0], lights[1]));
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
  const Image original = indirect(*session, preset(turnedRoom(turns[0])));
  const double noise = rms(original, indirect(*session, preset(turnedRoom(turns[0]), 2))), mean = static_cast<double>(meanOf(original).y);
  for (const Turn& turn : turns) {
    if (&turn == &turns[0]) continue;
    const Image turned = indirect(*session, preset(turnedRoom(turn), 3));
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
  const std::string scene = folder.write("cube.json", R"({"version": 1, "shapes": [{"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1],
      "facing": "inward", "face_materials": {"-x": "dark", "+y": "bright"}}],
    "materials": {"wall": {"albedo": 0.6}, "dark": {"albedo": 0.2}, "bright": {"albedo": 0.9}},
    "lights": [{"type": "point", "position": [0.3, 0.2, -0.4], "intensity": 5}],
    "cameras": [{"name": "c", "position": [0, 0, 0], "target": [0, 0, -1], "vertical_fov_degrees": 90}]})");
  auto session = makeSession();
  Preset p = preset(scene);
  p.width = p.height = 48;
  p.parameters["ddgi.spacing"] = "0.125";
  session->load(p);
  session->settle();
  double emitted = 0, reflected = 0, absorbed = 0;
  Camera camera = session->scene().cameras.front();
  for (const vec3 towards : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0), vec3(0, 0, 1), vec3(0, 0, -1)}) {
    camera.target = towards;
    camera.up = towards.y != 0 ? vec3(0, 0, 1) : vec3(0, 1, 0);
    session->setCamera(camera);
    session->frame();
    const double rho = static_cast<double>(meanOf(session->image("albedo")).x);
    const double direct = static_cast<double>(meanOf(session->image("direct")).x);  // irradiance
    emitted += 4 * direct;
    reflected += 4 * rho * direct;
    absorbed += 4 * (1 - rho) * static_cast<double>(meanOf(session->image("indirect_irradiance")).x);
  }
  const double flux = 4 * 3.14159265358979 * 5;
  std::printf("of %.3f W come in %.3f; reflected %.3f, absorbed of the indirect light %.3f: %+.2f %%\n", flux, emitted, reflected, absorbed, 100 * (absorbed / reflected - 1));
  EXPECT_NEAR(emitted, flux, 0.005 * flux);
  EXPECT_NEAR(absorbed, reflected, 0.03 * reflected);
  expectNoMessages(*session);
}

}  // namespace
}  // namespace hl::test
