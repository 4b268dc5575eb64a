// Walls that surfels stand on both sides of: light of the bright side must not come through. The camera sees both sides first, and then the wall from the dark one.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/scene_file.h"
#include "tests/session_fixture.h"
#include "tests/surfels_harness.h"

namespace hl::test {
namespace {

Camera look(vec3 from, vec3 to) {
  Camera c;
  c.position = from, c.target = to, c.verticalFov = 1.2f;
  return c;
}

/// Mean of the dark side over mean of the bright one.
double leak(Scene scene, const Camera& bright, const Camera& dark) {
  SurfelsHarness h(std::move(scene));
  h.set("surfels.max_surfels", "16384").set("surfels.radius_pixels", "3").set("surfels.place_chance", "1").set("surfels.ray_budget", "2");
  h.width = h.height = 48;
  h.rebuild();
  for (int turn = 0; turn < 2; ++turn) {
    for (int i = 0; i < 30; ++i) h.frame(bright);
    for (int i = 0; i < 30; ++i) h.frame(dark);
  }
  const double behind = h.mean();
  h.frame(bright);
  const double before = h.mean();
  EXPECT_GT(before, 0.01);
  return behind / before;
}

TEST(SurfelLeak, SealedRoomBehindAWallOfNoThickness) {
  const TemporaryFolder folder;
  const std::string path = folder.write("rooms.json", R"({"version": 1, "shapes": [
    {"type": "box", "material": "wall", "min": [-1, -1, -1], "max": [1, 1, 1], "facing": "inward"},
    {"type": "box", "material": "wall", "min": [1, -1, -1], "max": [3, 1, 1], "facing": "inward"},
    {"type": "quad", "material": "lamp", "corners": [[-0.2, 0.98, -0.2], [0.2, 0.98, -0.2], [0.2, 0.98, 0.2], [-0.2, 0.98, 0.2]]}],
    "materials": {"wall": {"albedo": 0.7}, "lamp": {"albedo": 0, "emission": [10, 10, 10]}},
    "cameras": [{"name": "c", "position": [0, 0, 0], "target": [1, 0, 0]}]})");
  const double share = leak(loadScene(path), look(vec3(-0.8f, 0.1f, 0.7f), vec3(1, -0.1f, -0.2f)), look(vec3(2.8f, 0.1f, 0.7f), vec3(1, -0.1f, -0.2f)));
  std::printf("leak, sealed room: %.2e\n", share);
  EXPECT_LE(share, 1e-2);
}

TEST(SurfelLeak, TwoRoomsWithTheDoorShut) {
  const double share = leak(loadScene("two_rooms"), look(vec3(0.3f, 1.6f, 3.6f), vec3(4.0f, 1.1f, 1.6f)), look(vec3(7.9f, 1.6f, 3.6f), vec3(4.2f, 1.1f, 1.6f)));
  std::printf("leak, two rooms: %.2e\n", share);
  EXPECT_LE(share, 1e-2);
}

TEST(SurfelLeak, TunnelWithAThinWall) {
  const double share = leak(loadScene("thin_wall_tunnel"), look(vec3(0.3f, 1.4f, 1.0f), vec3(8, 1.1f, 1.9f)), look(vec3(0.3f, 1.4f, 3.0f), vec3(8, 1.1f, 2.1f)));
  std::printf("leak, thin wall: %.2e\n", share);
  EXPECT_LE(share, 1e-2);
}

}  // namespace
}  // namespace hl::test
