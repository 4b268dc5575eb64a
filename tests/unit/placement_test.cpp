// Where probes stand: counts, nothing inside geometry, coverage against what can be worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "engine/placement/coverage.h"
#include "engine/placement/free_space.h"
#include "engine/placement/placement.h"
#include "engine/scene/scene_file.h"
#include "tests/trace_scenes.h"

namespace hl {
namespace {

using namespace test;

/// The six faces of a box, their fronts outside.
void addBlock(Scene& s, vec3 low, vec3 high, uint32_t material) {
  const vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
  addQuad(s, low, y, x, material), addQuad(s, low, z, y, material), addQuad(s, low, x, z, material);
  addQuad(s, high, -x, -y, material), addQuad(s, high, -y, -z, material), addQuad(s, high, -z, -x, material);
}

Scene room() {
  Scene s;
  addRoom(s, 0, 1, addMaterial(s));
  return s;
}

bool within(vec3 p, vec3 low, vec3 high) { return glm::all(glm::greaterThan(p, low)) && glm::all(glm::lessThan(p, high)); }

struct Placed {
  explicit Placed(Scene theScene, const ProbesParams& p = {}) : scene(std::move(theScene)), embree(scene) { probes = placeProbes(p, scene, embree, pool, progress); }
  Scene scene;
  TaskPool pool;
  Progress progress;
  EmbreeScene embree;
  PlacedProbes probes;
};

std::string messageOf(Scene scene, const ProbesParams& p) {
  try {
    Placed placed(std::move(scene), p);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(PlacementGrid, StandsInTheMiddleOfItsCells) {
  ProbesParams p;
  p.spacing = 0.25f;
  const Placed placed(room(), p);
  ASSERT_EQ(placed.probes.count(), 64u);
  EXPECT_EQ(placed.probes.coverage, 1);
  EXPECT_EQ(placed.probes.rejectedInside + placed.probes.rejectedNear + placed.probes.moved, 0u);
  EXPECT_FLOAT_EQ(placed.probes.positions.front().x, 0.125f);
  EXPECT_FLOAT_EQ(placed.probes.positions.back().z, 0.875f);
  EXPECT_EQ(placed.probes.inside, std::vector<uint8_t>(64, 0));
}

TEST(PlacementGrid, CountsGoBeforeTheSpacing) {
  ProbesParams p;
  p.count_x = 3, p.count_y = 1, p.count_z = 2;
  EXPECT_EQ(Placed(room(), p).probes.count(), 6u);
}

TEST(PlacementGrid, NoneStandsInASolidBlock) {
  Scene s = room();
  const vec3 low(0.3f, 0.0f, 0.35f), high(0.72f, 0.61f, 0.8f);
  addBlock(s, low, high, 0);
  ProbesParams p;
  p.spacing = 0.1f;
  p.surface_distance = 0.03f;
  const Placed placed(std::move(s), p);
  for (const vec3 at : placed.probes.positions) {
    EXPECT_FALSE(within(at, low - 0.029f, high + 0.029f)) << at.x << " " << at.y << " " << at.z;
    EXPECT_TRUE(within(at, vec3(0.029f), vec3(0.971f)));
  }
  // 4 x 6 x 4 or so centres lie inside: those of the block are left out, no other.
  uint64_t inBlock = 0;
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 10; ++y)
      for (int z = 0; z < 10; ++z) inBlock += within((vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) + 0.5f) / 10.0f, low, high);
  EXPECT_LE(placed.probes.rejectedInside, inBlock);
  EXPECT_EQ(placed.probes.count() + placed.probes.rejectedInside + placed.probes.rejectedNear, placed.probes.candidates);
  EXPECT_GE(placed.probes.count(), 1000 - inBlock);
}

TEST(PlacementGrid, TheSameTwiceAndOnAnyNumberOfThreads) {
  Scene s = furnishedRoom();
  const EmbreeScene embree(s);
  Progress progress;
  TaskPool one(1), many(5);
  const PlacedProbes a = placeProbes({}, s, embree, one, progress), b = placeProbes({}, s, embree, many, progress);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.coverage, b.coverage);
}

TEST(PlacementGrid, FollowsTheScale) {
  const auto scaled = [](float by) {
    Scene s = furnishedRoom();
    for (vec3& p : s.positions) p *= by;
    s.bounds.min *= by, s.bounds.max *= by;
    return s;
  };
  const Placed small(scaled(1.0f / 128)), large(scaled(128));
  ASSERT_EQ(small.probes.count(), large.probes.count());
  for (size_t i = 0; i < small.probes.count(); ++i) EXPECT_LT(glm::length(small.probes.positions[i] * 16384.0f - large.probes.positions[i]), 1e-3f);
  EXPECT_EQ(small.probes.coverage, large.probes.coverage);
}

TEST(PlacementGrid, TwoRooms) {
  const Placed placed(loadScene("two_rooms"));
  EXPECT_GT(placed.probes.count(), 20u);
  for (const vec3 at : placed.probes.positions) {
    EXPECT_FALSE(within(at, vec3(4, 0, -1), vec3(4.2f, 4, 1.45f))) << "inside the wall";
    EXPECT_FALSE(within(at, vec3(4, 0, 2.55f), vec3(4.2f, 4, 5))) << "inside the wall";
    EXPECT_FALSE(within(at, vec3(5.4f, 0, 0.8f), vec3(6.6f, 0.75f, 1.6f))) << "inside the table";
  }
  EXPECT_GT(placed.probes.coverage, 0.8);
}

TEST(PlacementGrid, AThinWallHidesWhatIsBehind) {
  Scene s = room();
  const uint32_t material = addMaterial(s);
  addBlock(s, {0.499f, 0, 0}, {0.501f, 1, 1}, material);
  ProbesParams p;
  p.count_x = p.count_y = p.count_z = 2;
  EXPECT_GT(Placed(s, p).probes.coverage, 0.99);
  // One row on one side: half of the room and one side of the wall. The wall's own rim is two thousandths of a metre wide.
  s.probes = {{0.25f, 0.5f, 0.5f}};
  p.placement = kPlacementManual;
  EXPECT_NEAR(Placed(s, p).probes.coverage, (3 + 1) / (6 + 2 + 0.008), 0.01);
}

constexpr vec3 kBlockLow(0.3f, 0.0f, 0.3f), kBlockHigh(0.75f, 0.62f, 0.75f);

/// The room with a solid block in it, and a camera beside it.
Scene roomWithBlock(bool twoSided) {
  Scene s = room();
  s.materials[0].twoSided = twoSided;
  addBlock(s, kBlockLow, kBlockHigh, 0);
  Camera camera;
  camera.position = vec3(0.1f, 0.8f, 0.1f);
  s.cameras.push_back(camera);
  return s;
}

TEST(PlacementGrid, NoneInATwoSidedSolid) {
  for (const bool twoSided : {false, true}) {
    ProbesParams p;
    p.count_x = p.count_y = p.count_z = 3;
    const Placed placed(roomWithBlock(twoSided), p);
    EXPECT_EQ(placed.probes.candidates, 27u);
    EXPECT_EQ(placed.probes.rejectedInside, 2u) << "the middle one, and the one below it";
    EXPECT_EQ(placed.probes.count(), 25u);
    for (const vec3 at : placed.probes.positions) EXPECT_FALSE(within(at, kBlockLow, kBlockHigh));
  }
}

ProbesParams greedy(float voxel = 0.1f, float radius = 0.4f) {
  ProbesParams p;
  p.placement = kPlacementVoxelGreedy;
  p.voxel = voxel, p.merge_radius = radius;
  return p;
}

TEST(PlacementVoxelGreedy, EveryCandidateHasAProbeThatSeesItWithinTheRadius) {
  const Placed all(furnishedRoom(), greedy(0.05f, 0)), few(furnishedRoom(), greedy(0.05f, 0.3f));
  ASSERT_GT(all.probes.count(), 4 * few.probes.count());
  EXPECT_EQ(few.probes.merged + few.probes.count(), all.probes.count());
  const float longest = std::max({few.scene.bounds.max.x - few.scene.bounds.min.x, few.scene.bounds.max.y - few.scene.bounds.min.y, few.scene.bounds.max.z - few.scene.bounds.min.z});
  for (const vec3 c : all.probes.positions)
    EXPECT_TRUE(std::any_of(few.probes.positions.begin(), few.probes.positions.end(), [&](vec3 q) {
      return glm::length(q - c) <= 0.3f * longest * 1.001f && !few.embree.occluded({q, 0, c - q, 1});
    })) << c.x << " " << c.y << " " << c.z;
  EXPECT_GT(few.probes.coverage, 0.98 * all.probes.coverage);
}

TEST(PlacementVoxelGreedy, NoneInASolidBlockNorOutsideTheRoom) {
  for (const bool twoSided : {false, true}) {
    const Placed placed(roomWithBlock(twoSided), greedy(0.05f, 0.3f));
    EXPECT_GT(placed.probes.count(), 4u);
    EXPECT_GT(placed.probes.rejectedInside, 0u);
    EXPECT_GT(placed.probes.coverage, 0.85);
    for (const vec3 at : placed.probes.positions) {
      EXPECT_FALSE(within(at, kBlockLow, kBlockHigh));
      EXPECT_TRUE(within(at, vec3(0.0f), vec3(1.0f)));
    }
  }
}

TEST(PlacementVoxelGreedy, ThinWall) {
  Scene s = room();
  addBlock(s, {0.499f, 0, 0}, {0.501f, 1, 1}, 0);
  const Placed placed(std::move(s), greedy());
  int left = 0, right = 0;
  for (const vec3 at : placed.probes.positions) ++(at.x < 0.5f ? left : right);
  EXPECT_GT(left, 0);
  EXPECT_GT(right, 0);
  EXPECT_GT(placed.probes.coverage, 0.98);
}

TEST(PlacementVoxelGreedy, TwoRoomsBehindAShutDoor) {
  const Placed placed(loadScene("two_rooms"), greedy(0.03f, 0.3f));
  int lit = 0, dark = 0;
  for (const vec3 at : placed.probes.positions) {
    EXPECT_TRUE(within(at, vec3(0, 0, 0), vec3(8.2f, 3, 4)));
    EXPECT_FALSE(within(at, vec3(5.4f, 0, 0.8f), vec3(6.6f, 0.75f, 1.6f))) << "inside the table";
    EXPECT_GT(glm::length(at - vec3(6, 1.05f, 1.2f)), 0.3f) << "inside the ball";
    ++(at.x < 4 ? lit : dark);
  }
  EXPECT_GT(lit, 2);
  EXPECT_GT(dark, 2);
}

TEST(PlacementVoxelGreedy, OneTriangle) {
  Scene s;
  addTriangle(s, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, addMaterial(s));
  const Placed placed(std::move(s), greedy());
  EXPECT_TRUE(std::any_of(placed.probes.positions.begin(), placed.probes.positions.end(), [](vec3 at) { return at.z > 0; }));
  EXPECT_EQ(placed.probes.coverage, 1);
}

TEST(PlacementVoxelGreedy, TooFineSaysSo) { EXPECT_NE(messageOf(room(), greedy(0.002f)).find("raise probes.voxel"), std::string::npos); }

/// Two-sided leaves and curtains, arcades, and a wall whose outside no camera sees.
TEST(PlacementSponza, BothStrategies) {
  if (!std::getenv("HALFLIGHT_SCENES")) GTEST_SKIP() << "HALFLIGHT_SCENES is not set: Sponza is not looked for";
  const Scene scene = loadScene("sponza");
  const EmbreeScene embree(scene);
  TaskPool pool;
  Progress progress;
  ProbesParams grid;
  grid.spacing = 0.08f;
  for (const ProbesParams& p : {grid, greedy(0.025f, 0.12f)}) {
    const PlacedProbes probes = placeProbes(p, scene, embree, pool, progress);
    std::printf("%s: %zu probes, coverage %.4f, %.2f s; of %llu places %llu inside, %llu too near, %llu moved, %llu merged\n", p.placement == kPlacementGrid ? "grid" : "voxel_greedy",
                probes.count(), probes.coverage, probes.seconds, static_cast<unsigned long long>(probes.candidates), static_cast<unsigned long long>(probes.rejectedInside),
                static_cast<unsigned long long>(probes.rejectedNear), static_cast<unsigned long long>(probes.moved), static_cast<unsigned long long>(probes.merged));
    // The outside of the walls is a good part of all surface, and no probe's business.
    EXPECT_GT(probes.coverage, p.placement == kPlacementGrid ? 0.5 : 0.7);
    for (const Surroundings& a : lookAround(embree, probes.positions, pool, progress)) EXPECT_LT(a.backs, p.inside_threshold);
    const float longest = scene.bounds.max.x - scene.bounds.min.x;
    for (const vec3 at : probes.positions) EXPECT_GE(embree.nearest(at, longest).distance, 0.999f * p.surface_distance * longest);
  }
}

TEST(PlacementHard, SceneWithoutSurfaces) {
  const Placed placed(Scene{});
  EXPECT_EQ(placed.probes.count(), 0u);
  EXPECT_EQ(placed.probes.coverage, 0);
}

TEST(PlacementHard, OneTriangleGetsAProbeInFront) {
  Scene s;
  addTriangle(s, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, addMaterial(s));
  ProbesParams p;
  p.count_x = p.count_y = 1;
  const Placed placed(std::move(s), p);
  ASSERT_EQ(placed.probes.count(), 1u);
  EXPECT_EQ(placed.probes.moved, 1u);
  EXPECT_GT(placed.probes.positions[0].z, 0);
  EXPECT_EQ(placed.probes.coverage, 1);
}

TEST(PlacementHard, NoPlaceLeftSaysSo) {
  Scene s;
  addBlock(s, vec3(0.0f), vec3(1.0f), addMaterial(s));
  EXPECT_NE(messageOf(std::move(s), {}).find("inside geometry"), std::string::npos);
}

TEST(PlacementHard, TooManySaySo) {
  ProbesParams p;
  p.count_x = p.count_y = p.count_z = 256;
  EXPECT_NE(messageOf(room(), p).find("raise probes.spacing"), std::string::npos);
}

TEST(PlacementHard, Cancelled) {
  const Scene s = room();
  const EmbreeScene embree(s);
  TaskPool pool;
  Progress progress;
  progress.cancel();
  EXPECT_THROW(placeProbes({}, s, embree, pool, progress), Error);
}

TEST(PlacementManual, ThoseInsideGeometryAreNamedAndKept) {
  Scene s = room();
  addBlock(s, vec3(0.2f), vec3(0.4f), 0);
  s.probes = {{0.5f, 0.5f, 0.5f}, {0.3f, 0.3f, 0.3f}, {0.9f, 0.1f, 0.9f}};
  ProbesParams p;
  p.placement = kPlacementManual;
  const Placed placed(s, p);
  EXPECT_EQ(placed.probes.positions, s.probes);
  EXPECT_EQ(placed.probes.inside, (std::vector<uint8_t>{0, 1, 0}));
  EXPECT_EQ(placed.probes.insideGeometry, 1u);
  ASSERT_EQ(placed.probes.warnings.size(), 1u);
  EXPECT_NE(placed.probes.warnings[0].find("number 2 at (0.3, 0.3, 0.3)"), std::string::npos) << placed.probes.warnings[0];
}

/// Bennett's counts (table 6.2), and his triangles.
TEST(PlacementManual, ScenesWithProbesOfTheirOwn) {
  ProbesParams p;
  p.placement = kPlacementManual;
  for (const auto& [name, count] : {std::pair<const char*, size_t>{"cornell_box", 27}, {"blue_orange_box", 20}}) {
    const Placed placed(loadScene(name), p);
    EXPECT_EQ(placed.probes.count(), count) << name;
    EXPECT_EQ(placed.probes.insideGeometry, 0u) << name;
    EXPECT_GT(placed.probes.coverage, 0.3) << name;
    std::printf("%s: %zu probes see %.3f of the area\n", name, placed.probes.count(), placed.probes.coverage);
    const float longest = std::max({placed.scene.bounds.max.x - placed.scene.bounds.min.x, placed.scene.bounds.max.y - placed.scene.bounds.min.y, placed.scene.bounds.max.z - placed.scene.bounds.min.z});
    for (const vec3 at : placed.probes.positions) EXPECT_GE(placed.embree.nearest(at, longest).distance, 0.02f * longest) << name << " " << at.x << " " << at.y << " " << at.z;
  }
  EXPECT_EQ(loadScene("blue_orange_box").triangles(), 96u);
  EXPECT_EQ(loadScene("blue_orange_box").regions.size(), 4u);
}

TEST(PlacementManual, NoneIsAnError) {
  ProbesParams p;
  p.placement = kPlacementManual;
  EXPECT_NE(messageOf(room(), p).find("has no probes of its own"), std::string::npos);
}

TEST(Nearest, AgainstAllTriangles) {
  const Scene s = furnishedRoom();
  const EmbreeScene embree(s);
  // Distances fall to zero on the surfaces themselves, and never exceed that to any point of them.
  const std::vector<SurfaceSample> samples = sampleSurfaces(s, 512);
  for (uint32_t i = 0; i < 100; ++i) {
    const vec3 p = samples[i * 5].position;
    EXPECT_LT(embree.nearest(p, 1).distance, 1e-5f);
    const vec3 q = s.bounds.min + (s.bounds.max - s.bounds.min) * vec3(static_cast<float>(i % 5) + 0.5f, static_cast<float>(i / 5 % 5) + 0.5f, static_cast<float>(i / 25) + 0.5f) / 5.0f;
    const NearestPoint n = embree.nearest(q, 1e9f);
    ASSERT_NE(n.triangle, kNone);
    for (const SurfaceSample& o : samples) EXPECT_LE(n.distance, glm::length(o.position - q) + 1e-5f);
    EXPECT_NEAR(n.distance, glm::length(n.position - q), 1e-6f);
  }
  EXPECT_EQ(embree.nearest(s.bounds.max + vec3(5.0f), 1).triangle, kNone);
}

TEST(Coverage, SamplesAreSpreadByArea) {
  Scene s;
  const uint32_t m = addMaterial(s);
  addQuad(s, vec3(0.0f), {1, 0, 0}, {0, 1, 0}, m);
  addQuad(s, vec3(0, 0, 1), {3, 0, 0}, {0, 1, 0}, m);
  int first = 0;
  for (const SurfaceSample& p : sampleSurfaces(s, 4096)) first += p.position.z < 0.5f;
  EXPECT_NEAR(first, 1024, 1);
}

}  // namespace
}  // namespace hl
