// Every tracer on moved poses: what was brought along by updates answers as one that was made there.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "engine/passes/pose.h"
#include "engine/scene/scene_pose.h"
#include "engine/trace/bvh_refit.h"
#include "engine/trace/tracer.h"
#include "tests/gpu_fixture.h"
#include "tests/moving_scenes.h"

namespace hl {
namespace {

using shared::Hit;
using shared::Ray;

std::vector<Ray> raysThrough(const Scene& scene, uint32_t count) {
  shared::Random r = shared::randomInit(11, 5, 2);
  const auto random = [&] { return shared::randomFloat(r); };
  std::vector<Ray> rays;
  const vec3 size = scene.bounds.max - scene.bounds.min;
  while (rays.size() < count) {
    const vec3 from = scene.bounds.min + size * vec3(random(), random(), random());
    const vec3 to = scene.bounds.min + size * vec3(random(), random(), random());
    if (glm::length(to - from) > 0) rays.push_back({from, 0, to - from, 2});
  }
  return rays;
}

class MovingTracers : public test::GpuTest {
 protected:
  struct Answers {
    std::vector<Hit> hits;
    std::vector<uint32_t> occluded;
  };
  Answers cast(Tracer& tracer, const std::vector<Ray>& rays) {
    const Buffer in = device->buffer("rays", std::span<const Ray>(rays));
    const Buffer hits = device->buffer("hits", rays.size() * sizeof(Hit)), flags = device->buffer("flags", rays.size() * sizeof(uint32_t));
    const auto n = static_cast<uint32_t>(rays.size());
    tracer.record(*graph, "closest", in, hits, n, Query::Closest);
    tracer.record(*graph, "any", in, flags, n, Query::Any);
    graph->execute();
    return {download<Hit>(hits), download<uint32_t>(flags)};
  }

  /// Follows `rest` through moments with one tracer, and makes another at each of them.
  void follow(const Scene& rest, const std::string& id) {
    SCOPED_TRACE(id);
    Scene scene = rest;
    ScenePose pose(scene);
    GpuScene gpuScene = uploadScene(*device, scene);
    const auto tracer = makeTracer(id, *device, *shaders, scene, gpuScene, nullptr, pool);
    const std::vector<Ray> rays = raysThrough(rest, 20'000);
    size_t different = 0;
    std::vector<Hit> before = cast(*tracer, rays).hits;
    for (const double time : {0.0, 0.13, 0.5, 0.9, 1.7, 0.2}) {
      if (pose.apply(scene, time).geometry) {
        updateTransforms(*device, gpuScene, pose.transforms());
        recordPose(*graph, gpuScene);
        tracer->recordUpdate(*graph);
        graph->execute();
      }
      const Answers moved = cast(*tracer, rays);
      GpuScene there = uploadScene(*device, rest);
      device->upload(there.positions, scene.positions.data(), scene.positions.size() * sizeof(vec3));
      const auto fresh = makeTracer(id, *device, *shaders, scene, there, nullptr, pool);
      const Answers made = cast(*fresh, rays);
      size_t unequal = 0, occlusion = 0, hits = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        const Hit &a = moved.hits[i], &b = made.hits[i];
        hits += b.primitive != shared::kMiss;
        const bool miss = a.primitive == shared::kMiss, same = miss == (b.primitive == shared::kMiss) && (miss || std::abs(a.t - b.t) <= 1e-4f * std::max(a.t, b.t));
        unequal += same ? 0 : 1;
        occlusion += moved.occluded[i] != made.occluded[i];
        different += a.primitive != before[i].primitive;
      }
      EXPECT_GT(hits, rays.size() / 20);
      // Edges that rounding decides: host and device work out a vertex to a unit in the last place.
      EXPECT_LE(unequal, rays.size() / 2000) << "at " << time;
      EXPECT_LE(occlusion, rays.size() / 2000) << "at " << time;
      before = moved.hits;
    }
    EXPECT_GT(different, rays.size() / 50) << "nothing moved";
  }

  void followAll(const Scene& rest) {
    for (const TracerListing& t : listTracers(*device))
      if (t.available) follow(rest, t.id);
  }
  TaskPool pool;
};

TEST_F(MovingTracers, FollowTurningObjects) { followAll(test::turningRoom()); }
TEST_F(MovingTracers, FollowAlphaTestedOnes) { followAll(test::windyFoliage()); }

TEST_F(MovingTracers, RecordNothingWhereNothingCanMove) {
  const Scene scene = test::furnishedRoom();
  GpuScene gpuScene = uploadScene(*device, scene);
  for (const TracerListing& t : listTracers(*device)) {
    if (!t.available || t.id == "embree") continue;  // embree's pass finds an empty list
    makeTracer(t.id, *device, *shaders, scene, gpuScene, nullptr, pool)->recordUpdate(*graph);
    EXPECT_TRUE(graph->execute().passes.empty()) << t.id;
  }
}

/// The plan against a walk over all nodes, and its measure against a tree that was not touched.
TEST_F(MovingTracers, ARefittedTreeKnowsItsCost) {
  Scene scene = test::turningRoom();
  const Bvh bvh = buildBvh(scene, {}, pool);
  const BvhRefit refit = planRefit(bvh, movingTriangles(scene));
  size_t moving = 0;
  for (const bool m : movingTriangles(scene)) moving += m;
  EXPECT_EQ(refit.triangles.size(), moving);
  ASSERT_FALSE(refit.nodes.empty());
  EXPECT_EQ(refit.nodes.back(), 0u) << "the root is last";
  EXPECT_EQ(refit.levels.back(), refit.nodes.size());
  const auto halfArea = [&](uint32_t node, int c) {
    vec3 e;
    for (int axis = 0; axis < 3; ++axis) e[axis] = bvh.nodes[node * 7u + 2u * static_cast<uint32_t>(axis) + 1u][c] - bvh.nodes[node * 7u + 2u * static_cast<uint32_t>(axis)][c];
    return e.x * e.y + e.y * e.z + e.z * e.x;
  };
  std::vector<float> areas;
  for (const uint32_t node : refit.nodes) {
    float sum = 0;
    for (int c = 0; c < 4; ++c) {
      if (bvh.nodes[node * 7u][c] > bvh.nodes[node * 7u + 1u][c]) continue;
      const auto word = std::bit_cast<uint32_t>(bvh.nodes[node * 7u + 6u][c]);
      sum += halfArea(node, c) * (word & kBvhLeafBit ? static_cast<float>((word >> kBvhCountShift & 7u) + 1) : 1.0f);
    }
    areas.push_back(sum);
  }
  Bounds all;
  for (const uvec3 t : scene.indices)
    for (const uint32_t v : {t.x, t.y, t.z}) all.extend(scene.positions[v]);
  const vec3 e = all.max - all.min;
  EXPECT_NEAR(costAfterRefit(refit, areas, e.x * e.y + e.y * e.z + e.z * e.x), bvh.cost, 1e-3 * bvh.cost);
}

}  // namespace
}  // namespace hl
