#pragma once
// Scenes and sums for what a result must not depend on, and what must balance (MEASURES.md section 1).
#include <fmt/core.h>

#include <cmath>
#include <string>

#include "tests/session_fixture.h"

namespace hl::test {

/// Of a room's points: p -> M p, with rows of M. Boxes stay boxes: rows are axes.
struct Turn {
  const char* name;
  mat3 m;
  bool mirrors, movesPole;
};

/// Root of the mean squared difference over channels; `flipped`: of `b` seen in a mirror.
inline double rms(const Image& a, const Image& b, bool flipped = false) {
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
inline std::string turnedRoom(const TemporaryFolder& folder, const Turn& turn) {
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

inline const char* const kTwoLights[] = {R"({"type": "point", "position": [0.6, 0.7, 0.2], "intensity": [3, 2, 1]})",
                                R"({"type": "spot", "position": [-0.7, 0.5, 0.6], "direction": [1, -0.6, -0.5], "intensity": [1, 4, 9], "inner_degrees": 20, "outer_degrees": 35})"};

/// A box with a block in it and a camera, under the lights of a scene file's list.
inline std::string litRoom(const TemporaryFolder& folder, const std::string& lights) {
  std::string text = R"({"version": 1, "shapes": [{"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1],
      "facing": "inward"}, {"type": "box", "material": "wall", "min": [-0.4, -1, -0.5], "max": [0.2, -0.3, 0]}], "materials": {"wall": {"albedo": [0.7, 0.5, 0.3]}},
      "cameras": [{"name": "c", "position": [0.8, 0.1, 0.9], "target": [-0.3, -0.4, -0.3], "vertical_fov_degrees": 75}], "lights": [)";
  text += lights;
  text += "]}";
  return folder.write("lit.json", text);
}

/// A cube whose faces differ, with a point light off its centre, and its camera at the centre.
inline std::string unevenCube(const TemporaryFolder& folder) {
  return folder.write("cube.json", R"({"version": 1, "shapes": [{"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1],
      "facing": "inward", "face_materials": {"-x": "dark", "+y": "bright"}}],
    "materials": {"wall": {"albedo": 0.6}, "dark": {"albedo": 0.2}, "bright": {"albedo": 0.9}},
    "lights": [{"type": "point", "position": [0.3, 0.2, -0.4], "intensity": 5}],
    "cameras": [{"name": "c", "position": [0, 0, 0], "target": [0, 0, -1], "vertical_fov_degrees": 90}]})");
}
inline constexpr double kUnevenCubeFlux = 4 * 3.14159265358979 * 5;

/// Sums over a cube's faces of side 2, area times a flux density [W].
struct Balance {
  double emitted = 0;    ///< direct light that comes in
  double reflected = 0;  ///< of that
  double absorbed = 0;   ///< of the indirect light
};

/// Whatever shines, and wherever: what walls absorb of the indirect light, sum A (1 - rho) E, is what they reflected of the direct light, sum A rho E. A camera
/// with a square picture of 90 degrees at the centre of a cube sees one face, each part of it in as many pixels as any other; it looks at each for `frames`.
inline Balance balanceIn(Session& session, int frames) {
  Balance b;
  Camera camera = session.scene().cameras.front();
  for (const vec3 towards : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0), vec3(0, 0, 1), vec3(0, 0, -1)}) {
    camera.target = towards;
    camera.up = towards.y != 0 ? vec3(0, 0, 1) : vec3(0, 1, 0);
    session.setCamera(camera);
    for (int i = 0; i < frames; ++i) session.frame();
    const double rho = static_cast<double>(meanOf(session.image("albedo")).x);
    const double direct = static_cast<double>(meanOf(session.image("direct")).x);  // irradiance
    b.emitted += 4 * direct;
    b.reflected += 4 * rho * direct;
    b.absorbed += 4 * (1 - rho) * static_cast<double>(meanOf(session.image("indirect_irradiance")).x);
  }
  return b;
}

inline void expectReflectedIsAbsorbed(const Balance& b, double tolerance) {
  std::printf("of %.3f W come in %.3f; reflected %.3f, absorbed of the indirect light %.3f: %+.2f %%\n", kUnevenCubeFlux, b.emitted, b.reflected, b.absorbed,
              100 * (b.absorbed / b.reflected - 1));
  EXPECT_NEAR(b.emitted, kUnevenCubeFlux, 0.005 * kUnevenCubeFlux);
  EXPECT_NEAR(b.absorbed, b.reflected, tolerance * b.reflected);
}

}  // namespace hl::test
