#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "engine/scene/texture_sampling.h"
#include "engine/trace/alpha_test.h"
#include "engine/trace/embree_scene.h"
#include "tests/trace_scenes.h"

namespace hl {
namespace {

using shared::Hit;
using shared::kMiss;
using shared::Ray;

TEST(EmbreeScene, HitsInUnitsOfTheDirectionsLength) {
  Scene scene;
  test::addTriangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, test::addMaterial(scene));
  const EmbreeScene embree(scene);
  const Hit hit = embree.closest(Ray{{0.25f, 0.5f, 1}, 0, {0, 0, -4}, 10});
  EXPECT_EQ(hit.primitive, 0u);
  EXPECT_FLOAT_EQ(hit.t, 0.25f);
  EXPECT_FLOAT_EQ(hit.u, 0.25f);
  EXPECT_FLOAT_EQ(hit.v, 0.5f);
  EXPECT_EQ(embree.closest(Ray{{0.25f, 0.5f, 1}, 0, {0, 0, -4}, 0.2f}).primitive, kMiss);
  EXPECT_EQ(embree.closest(Ray{{0.25f, 0.5f, 1}, 0.3f, {0, 0, -4}, 10}).primitive, kMiss);
}

TEST(EmbreeScene, InactiveRaysReadAsMisses) {
  Scene scene;
  test::addRoom(scene, -1, 1, test::addMaterial(scene));
  const EmbreeScene embree(scene);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Ray> rays;
  for (const auto& [tMin, tMax] :
       std::vector<std::pair<float, float>>{{1, 0}, {0, -1}, {-2, -1}, {5, 4}, {nan, 1}, {0, nan}})
    rays.push_back({vec3(0.0f), tMin, {0, 0, 1}, tMax});
  rays.push_back({vec3(0.0f), 0, vec3(0.0f), 10});  // no direction
  std::vector<Hit> hits(rays.size());
  std::vector<uint32_t> occluded(rays.size(), 7);
  embree.closest(rays, hits);
  embree.occluded(rays, occluded);
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(hits[i].primitive, kMiss) << i;
    EXPECT_EQ(occluded[i], 0u) << i;
    EXPECT_EQ(embree.closest(rays[i]).primitive, kMiss) << i;
    EXPECT_FALSE(embree.occluded(rays[i])) << i;
  }
}

TEST(EmbreeScene, NothingThereIsAMiss) {
  const Scene scene;
  const EmbreeScene embree(scene);
  EXPECT_EQ(embree.closest(Ray{vec3(0.0f), 0, {0, 0, 1}, 1e30f}).primitive, kMiss);
  EXPECT_FALSE(embree.occluded(Ray{vec3(0.0f), 0, {0, 0, 1}, 1e30f}));
}

TEST(EmbreeScene, BatchesGiveWhatSingleRaysGive) {
  for (const Scene& scene : {test::furnishedRoom(), test::foliage()}) {
    const EmbreeScene embree(scene);
    std::vector<Ray> rays;
    for (uint32_t i = 0; i < 1001; ++i) {  // not a multiple of the stream's length
      shared::Random r = shared::randomInit(1, i, 0);
      const auto random = [&] { return shared::randomFloat(r); };
      rays.push_back({{random(), random(), random()},
                      0,
                      {random() - 0.5f, random() - 0.5f, random() - 0.5f},
                      i % 3 == 0 ? 0.5f : 1e30f});
    }
    std::vector<Hit> hits(rays.size());
    std::vector<uint32_t> occluded(rays.size());
    embree.closest(rays, hits);
    embree.occluded(rays, occluded);
    size_t found = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      const Hit single = embree.closest(rays[i]);
      EXPECT_EQ(single.primitive, hits[i].primitive) << i;
      EXPECT_EQ(single.t, hits[i].t) << i;
      EXPECT_EQ(embree.occluded(rays[i]), occluded[i] == 1) << i;
      EXPECT_EQ(single.primitive != kMiss, occluded[i] == 1) << i;
      found += occluded[i];
    }
    EXPECT_GT(found, rays.size() / 10);
  }
}

/// Of rays that belong together and of some that do not, with lanes at rest among them and at the end.
TEST(EmbreeScene, PacketsGiveWhatSingleRaysGive) {
  for (const Scene& scene : {test::furnishedRoom(), test::foliage()}) {
    const EmbreeScene embree(scene);
    size_t found = 0;
    for (uint32_t k = 0; k < 400; ++k) {
      shared::Random r = shared::randomInit(3, k, 0);
      const auto random = [&] { return shared::randomFloat(r); };
      const vec3 origin(random(), random(), random()), towards(random() - 0.5f, random() - 0.5f, random() - 0.5f);
      const float spread = k % 4 == 0 ? 1.0f : 0.02f;
      const uint32_t count = k % 3 == 0 ? kPacketRays - k % kPacketRays : kPacketRays;
      RayPacket packet;
      std::array<Ray, kPacketRays> rays;
      for (uint32_t i = 0; i < kPacketRays; ++i) {
        const vec3 d = towards + spread * vec3(random() - 0.5f, random() - 0.5f, random() - 0.5f);
        rays[i] = {origin, k % 5 == 0 ? 0.1f : -1.0f, d, (i + k) % 7 == 0 ? -2.0f : (k % 2 == 0 ? 0.7f : 1e30f)};
        packet.originX[i] = origin.x, packet.originY[i] = origin.y, packet.originZ[i] = origin.z;
        packet.directionX[i] = d.x, packet.directionY[i] = d.y, packet.directionZ[i] = d.z;
        packet.tMin[i] = rays[i].tMin, packet.tMax[i] = rays[i].tMax;
      }
      embree.closest(packet, count);
      for (uint32_t i = 0; i < count; ++i) {
        const Hit single = embree.closest(rays[i]);
        ASSERT_EQ(single.primitive, packet.primitive[i]) << k << " " << i;
        if (single.primitive == kMiss) continue;
        ++found;
        ASSERT_NEAR(single.t, packet.t[i], 1e-5f * single.t) << k << " " << i;
        ASSERT_NEAR(single.u, packet.u[i], 1e-4f) << k << " " << i;
        ASSERT_NEAR(single.v, packet.v[i], 1e-4f) << k << " " << i;
      }
    }
    EXPECT_GT(found, 600u);
  }
}

TEST(EmbreeScene, AlphaTestedSurfacesCountWhereTheyAreOpaque) {
  const Scene scene = test::foliage();
  const EmbreeScene embree(scene);
  size_t opaque = 0, through = 0;
  for (uint32_t i = 0; i < 4000; ++i) {
    shared::Random r = shared::randomInit(2, i, 0);
    const Ray ray{{shared::randomFloat(r) * 2 - 1, shared::randomFloat(r) * 2 - 1, 2}, 0, {0, 0, -1}, 10};
    const Hit hit = embree.closest(ray);
    ASSERT_NE(hit.primitive, kMiss);  // the wall is behind everything
    EXPECT_TRUE(opaqueAt(scene, hit.primitive, hit.u, hit.v));
    (hit.primitive < 2 ? through : opaque) += 1;
  }
  EXPECT_GT(opaque, 400u);
  EXPECT_GT(through, 400u);
}

TEST(EmbreeScene, OnlyTexturesWithHolesNeedTesting) {
  Scene scene = test::foliage();
  EXPECT_FALSE(alphaTestedTriangles(scene).empty());
  for (size_t i = 3; i < scene.textures[1].rgba.size(); i += 4) scene.textures[1].rgba[i] = 255;
  EXPECT_TRUE(alphaTestedTriangles(scene).empty());
}

TEST(EmbreeScene, BuildingCanBeCancelled) {
  const Scene scene = test::furnishedRoom();
  Progress progress;
  progress.cancel();
  try {
    const EmbreeScene embree(scene, &progress);
    FAIL() << "was not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::Cancelled);
  }
}

}  // namespace
}  // namespace hl
