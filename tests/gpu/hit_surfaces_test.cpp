// Surfaces at ray hits against the reference's own, and their direct light against the service asked for the same points.
#include "engine/passes/hit_surfaces.h"

#include "engine/reference/surface.h"
#include "shaders/passes/hit_surfaces.h"
#include "shaders/shared/random.h"
#include "shaders/shared/sampling.h"
#include "shaders/shared/surface_point.h"
#include "tests/gpu_fixture.h"
#include "tests/trace_scenes.h"

namespace hl::test {
namespace {

constexpr uint32_t kRays = 3000, kFirst = 500;
constexpr float kOffset = 1e-4f;

class HitSurfacesTest : public GpuTest {
 protected:
  /// Leaves before a wall: textured and seen from both sides, some materials one-sided.
  void use(Scene s) {
    scene = std::move(s);
    PointLight lamp;
    lamp.position = vec3(0.2f, 0.4f, 1.5f);
    scene.pointLights = {lamp};
    gpuScene = uploadScene(*device, scene);
    tracer = makeTracer("embree", *device, *shaders, scene, gpuScene, nullptr, pool);
    light = std::make_unique<DirectLight>(*device, *shaders, gpuScene, *tracer);
    hitSurfaces = std::make_unique<HitSurfaces>(*device, gpuScene, *light);
    rayData.clear();
    for (uint32_t i = 0; i < kRays; ++i) {
      shared::Random r = shared::randomInit(11, i, 0);
      const vec2 u(shared::randomFloat(r), shared::randomFloat(r));
      const vec3 from(shared::randomFloat(r) - 0.5f, shared::randomFloat(r) - 0.5f, shared::randomFloat(r) - 0.5f);
      rayData.push_back({from, 0.0f, shared::sampleUniformSphere(u), 1e30f});
    }
    rays = device->buffer("rays", std::span<const shared::Ray>(rayData));
    hits = device->buffer("hits", kRays * sizeof(shared::Hit));
    tracer->record(*graph, "cast", rays, hits, kRays, Query::Closest);
    graph->execute();
    hitData = download<shared::Hit>(hits);
  }
  HitSurfaces::Rays batch(uint32_t first, uint32_t count) const { return {rays, hits, first, count, kOffset, 5, 3}; }

  Scene scene;
  GpuScene gpuScene;
  TaskPool pool;
  std::unique_ptr<Tracer> tracer;
  std::unique_ptr<DirectLight> light;
  std::unique_ptr<HitSurfaces> hitSurfaces;
  std::vector<shared::Ray> rayData;
  std::vector<shared::Hit> hitData;
  Buffer rays, hits;
};

class HitSides : public HitSurfacesTest, public ::testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(TwoSided, HitSides, ::testing::Bool());

TEST_P(HitSides, AreTheReferencesSurfaces) {
  Scene leaves = foliage();
  leaves.materials[1].twoSided = GetParam();
  leaves.materials[0].albedo = vec3(1.0f, 0.5f, 0.2f);  // over the limit
  use(std::move(leaves));
  hitSurfaces->record(*graph, "test", batch(kFirst, kRays - kFirst));
  graph->execute();
  const auto points = download<shared::SurfacePoint>(hitSurfaces->points());
  const auto albedo = download<vec4>(hitSurfaces->albedo());
  double misses = 0, backs = 0, surfaces = 0;
  for (uint32_t i = 0; i < kRays - kFirst; ++i) {
    const shared::Hit& hit = hitData[kFirst + i];
    const shared::SurfacePoint& p = points[i];
    if (hit.primitive == shared::kMiss) {
      ++misses;
      EXPECT_EQ(p.flags, shared::kHitNothing);
      EXPECT_EQ(glm::length(p.normal), 0.0f);
      continue;
    }
    const Surface s = surfaceAt(scene, hit, rayData[kFirst + i].direction, true);
    ASSERT_LT(glm::length(p.position - s.position), 1e-5f);
    EXPECT_EQ(p.triangle, hit.primitive);
    EXPECT_EQ(p.offset, kOffset);
    if (s.backFace && !s.twoSided) {
      ++backs;
      EXPECT_EQ(p.flags, shared::kHitBackFace);
      EXPECT_EQ(glm::length(p.normal), 0.0f);
      EXPECT_EQ(albedo[i], vec4(0.0f));
      continue;
    }
    ++surfaces;
    EXPECT_EQ(p.flags, shared::kHitSurface);
    ASSERT_LT(glm::length(p.normal - s.normal), 1e-4f);
    ASSERT_LT(glm::length(p.geometricNormal - s.geometricNormal), 1e-4f);
    ASSERT_LT(glm::length(vec3(albedo[i].x, albedo[i].y, albedo[i].z) - s.albedo), 1e-3f);
    EXPECT_EQ(albedo[i].w, 1.0f);
  }
  EXPECT_GT(misses, 100);
  EXPECT_EQ(backs > 20, !GetParam());
  EXPECT_GT(surfaces, 300);
  EXPECT_EQ(hitSurfaces->counters()[0].second, misses);
  EXPECT_EQ(hitSurfaces->counters()[1].second, backs);
  hitSurfaces->record(*graph, "test", batch(kFirst, kRays - kFirst));
  graph->execute();
  EXPECT_EQ(hitSurfaces->counters()[1].second, 2 * backs);
  hitSurfaces->resetCounters();
  EXPECT_EQ(hitSurfaces->counters()[1].second, 0);
}

TEST_F(HitSurfacesTest, DirectLightIsTheServices) {
  Scene room = furnishedRoom();
  addQuad(room, vec3(0.3f, 0.99f, 0.3f), vec3(0.4f, 0, 0), vec3(0, 0, 0.4f), addMaterial(room, vec3(3.0f)));
  use(std::move(room));
  hitSurfaces->record(*graph, "test", batch(0, kRays));
  const Buffer sum = device->buffer("sum", kRays * sizeof(vec4));
  graph->clear("clear", sum);
  light->record(*graph, "again", hitSurfaces->points(), sum, 0, kRays, 5, 3);
  graph->execute();
  const auto direct = download<vec4>(hitSurfaces->direct()), again = download<vec4>(sum);
  double total = 0;
  for (uint32_t i = 0; i < kRays; ++i) {
    ASSERT_EQ(direct[i], again[i]);
    EXPECT_EQ(direct[i].w, 1.0f);
    total += static_cast<double>(direct[i].x);
  }
  EXPECT_GT(total, 0);
}

TEST_F(HitSurfacesTest, RefusesRaysThatAreNotThere) {
  use(furnishedRoom());
  const Error e = errorOf([&] { hitSurfaces->record(*graph, "test", batch(kFirst, kRays)); });
  EXPECT_NE(std::string(e.what()).find("rays [500, 3500) lie outside buffer rays"), std::string::npos) << e.what();
}

}  // namespace
}  // namespace hl::test
