// Where probes stand: counts, nothing inside geometry, coverage against what can be worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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
