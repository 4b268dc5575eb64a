// The scene on the device: what shaders look up is what the host looks up, textures included.
#include <cmath>
#include <random>

#include "engine/scene/gpu_scene.h"
#include "engine/scene/scene_build.h"
#include "engine/scene/texture_sampling.h"
#include "shaders/shared/scene_types.h"
#include "tests/gpu_fixture.h"

namespace hl {
namespace {

struct Place {
  uint32_t triangle = 0;
  float u = 0, v = 0;
  uint32_t unused = 0;
};
struct Found {  // as in tests/shaders/scene_fetch.comp
  vec3 position;
  float alpha;
  vec3 geometricNormal;
  uint32_t object;
  vec3 smoothNormal;
  uint32_t opaque;
  vec3 mapped;
  float area;
  vec3 albedo;
  float lightIntensity;
  vec3 emission;
  float emitterArea;
  vec2 uv;
  uint32_t unused[2];
};

Texture noise(int width, int height, bool srgb, uint32_t seed) {
  Texture t;
  t.name = "noise", t.width = width, t.height = height, t.srgb = srgb;
  std::mt19937 random(seed);
  for (int i = 0; i < 4 * width * height; ++i) t.rgba.push_back(static_cast<uint8_t>(random() >> 24));
  return t;
}

/// Two slanted triangles a material, with texture coordinates far outside [0, 1] and textures of three sizes.
Scene texturedScene() {
  Scene s;
  s.textures = {noise(64, 64, true, 1), noise(24, 40, true, 2), noise(7, 5, false, 3)};
  for (uint32_t i = 0; i < 3; ++i) {
    Material m;
    m.name = std::to_string(i);
    m.albedo = vec3(1.0f, 0.75f, 0.5f);
    if (i < 2) m.albedoTexture = i, m.normalTexture = 2, m.alphaCutoff = 0.5f;
    s.materials.push_back(m);
  }
  s.materials[2].emission = vec3(3, 2, 1);
  for (uint32_t k = 0; k < 6; ++k) {
    const auto f = static_cast<float>(k);
    const uint32_t base = static_cast<uint32_t>(s.positions.size());
    const vec3 p[3] = {vec3(f, 0, 0.1f * f), vec3(f + 1, 0.3f, 0), vec3(f, 1, 0.5f)};
    const vec3 n = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (uint32_t c = 0; c < 3; ++c) {
      s.positions.push_back(p[c]);
      s.normals.push_back(glm::normalize(n + 0.2f * vec3(static_cast<float>(c), 0.5f, 0)));
    }
    s.uvs.insert(s.uvs.end(), {vec2(-2.3f * f, 0.4f), vec2(3.7f, -1.9f * f), vec2(0.25f, k % 2 ? 5.5f : -5.5f)});
    s.indices.push_back({base, base + 1, base + 2});
    s.materialIds.push_back(k % 3);
    s.objectIds.push_back(k / 3);
  }
  s.hasUvs = true;
  s.objects = {"a", "b"};
  s.pointLights.push_back({"lamp", vec3(1, 2, 3), vec3(5, 6, 7)});
  finishScene(s);
  return s;
}

class SceneGpu : public test::GpuTest {
 protected:
  std::vector<Found> fetch(const GpuScene& g, const std::vector<Place>& places) {
    const Buffer in = device->buffer("places", std::span<const Place>(places)),
                 out = device->buffer("found", places.size() * sizeof(Found));
    graph->compute("fetch", "tests/scene_fetch.comp")
        .bind("places", in, Access::Read)
        .bind("found", out, Access::Write)
        .bind("positions", g.positions, Access::Read)
        .bind("normals", g.normals, Access::Read)
        .bind("uvs", g.uvs, Access::Read)
        .bind("indices", g.indices, Access::Read)
        .bind("material_ids", g.materialIds, Access::Read)
        .bind("object_ids", g.objectIds, Access::Read)
        .bind("materials", g.materials, Access::Read)
        .bind("lights", g.lights, Access::Read)
        .bind("emitters", g.emitters, Access::Read)
        .sample("textures", g.textures)
        .dispatchThreads(static_cast<uint32_t>(places.size()));
    graph->execute();
    return download<Found>(out);
  }
};

float distance(vec3 a, vec3 b) { return glm::length(a - b); }

TEST_F(SceneGpu, DeviceLooksUpWhatTheHostDoes) {
  const Scene s = texturedScene();
  const GpuScene g = uploadScene(*device, s);
  std::vector<Place> places;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  for (uint32_t k = 0; k < 6000; ++k) {
    float u = unit(random), v = unit(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    places.push_back({k % 6, u, v, 0});
  }
  for (uint32_t t = 0; t < 6; ++t) places.insert(places.end(), {{t, 0, 0, 0}, {t, 1, 0, 0}, {t, 0, 1, 0}});
  const std::vector<Found> found = fetch(g, places);
  ASSERT_EQ(found.size(), places.size());
  float worstAlbedo = 0, worstAlpha = 0;
  int disagreeing = 0;
  for (size_t k = 0; k < found.size(); ++k) {
    const Place& p = places[k];
    const Found& f = found[k];
    const uvec3 i = s.indices[p.triangle];
    const Material& m = s.materials[s.materialIds[p.triangle]];
    const auto blend = [&](const std::vector<vec3>& a) {
      return (1 - p.u - p.v) * a[i.x] + p.u * a[i.y] + p.v * a[i.z];
    };
    ASSERT_LT(distance(f.position, blend(s.positions)), 1e-5f);
    const vec3 across = glm::cross(s.positions[i.y] - s.positions[i.x], s.positions[i.z] - s.positions[i.x]);
    ASSERT_LT(distance(f.geometricNormal, glm::normalize(across)), 1e-5f);
    ASSERT_NEAR(f.area, 0.5f * glm::length(across), 1e-5f);
    ASSERT_LT(distance(f.smoothNormal, glm::normalize(blend(s.normals))), 1e-5f);
    const vec2 uv = uvAt(s, p.triangle, p.u, p.v);
    ASSERT_LT(glm::length(f.uv - uv), 1e-5f);
    // Texture values at the device's own coordinates: a rounding of those moves the sample by up to 1e-5 of a texel's
    // step.
    worstAlbedo = std::max(worstAlbedo, distance(f.albedo, albedoAt(s, m, f.uv)));
    const float alpha = m.albedoTexture == kNone ? 1.0f : sampleAlpha(s.textures[m.albedoTexture], f.uv);
    worstAlpha = std::max(worstAlpha, std::abs(f.alpha - alpha));
    disagreeing += (f.opaque != 0) != opaqueAt(s, m, f.uv) && std::abs(alpha - m.alphaCutoff) > 1e-5f;
    ASSERT_EQ(f.object, s.objectIds[p.triangle]);
    ASSERT_EQ(f.emission, m.emission);
    ASSERT_EQ(f.lightIntensity, 5.0f);
    ASSERT_NEAR(glm::length(f.mapped), 1, 1e-5f);
    if (m.normalTexture == kNone) {
      ASSERT_EQ(f.mapped, f.smoothNormal);
    }
  }
  RecordProperty("worst_albedo", std::to_string(worstAlbedo));
  EXPECT_LT(worstAlbedo, 1e-4f);
  EXPECT_LT(worstAlpha, 1e-5f);
  EXPECT_EQ(disagreeing, 0);
}

TEST_F(SceneGpu, NormalMapsFollowTheTextureDirections) {
  // One texel: normals of 0.6 along +u, then along +v, in a square whose u runs along -y and v along +x.
  for (const bool alongV : {false, true})
    for (const bool mirrored : {false, true}) {
      Scene s;
      Texture t;
      t.width = t.height = 1, t.srgb = false;
      const auto code = [](float x) { return static_cast<uint8_t>(std::lround((x * 0.5f + 0.5f) * 255)); };
      t.rgba = {code(alongV ? 0.0f : 0.6f), code(alongV ? 0.6f : 0.0f), code(0.8f), 255};
      s.textures = {t};
      s.materials.resize(1);
      s.materials[0].normalTexture = 0;
      s.positions = {vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0)};
      s.normals.assign(3, vec3(0, 0, 1));
      for (const vec3 p : s.positions) s.uvs.push_back(vec2(mirrored ? p.y : -p.y, p.x));
      s.indices = {{0, 1, 2}};
      s.materialIds = s.objectIds = {0};
      s.objects = {"a"};
      finishScene(s);
      const Found f = fetch(uploadScene(*device, s), {{0, 0.25f, 0.25f, 0}})[0];
      const vec3 side = alongV ? vec3(0.6f, 0, 0.8f) : vec3(0, mirrored ? 0.6f : -0.6f, 0.8f);
      EXPECT_LT(distance(f.mapped, side), 0.01f) << alongV << mirrored;
    }
}

TEST_F(SceneGpu, CountsPowersAndUpdates) {
  Scene s = texturedScene();
  s.spotLights.push_back({"spot", vec3(1.0f), vec3(0, -1, 0), vec3(2.0f), 0.2f, 0.4f});
  s.directionalLights.push_back({"sun", vec3(0, -1, 0), vec3(3.0f)});
  s.sky = vec3(0.5f);
  GpuScene g = uploadScene(*device, s);
  EXPECT_EQ(g.triangleCount, 6u);
  EXPECT_EQ(g.lightCount, 3u);
  EXPECT_EQ(g.emitterCount, 2u);
  EXPECT_TRUE(g.features.normalMaps && g.features.alphaTested && g.features.spotLights);
  const auto lights = download<shared::GpuLight>(g.lights);
  EXPECT_EQ(lights[0].type, shared::kLightPoint);
  EXPECT_EQ(lights[1].type, shared::kLightSpot);
  EXPECT_FLOAT_EQ(lights[1].cosOuter, std::cos(0.4f));
  EXPECT_EQ(lights[2].type, shared::kLightDirectional);
  EXPECT_EQ(lights[2].intensity, vec3(3.0f));
  const auto emitters = download<shared::GpuEmitter>(g.emitters);
  float total = 0;
  for (const shared::GpuEmitter& e : emitters) {
    EXPECT_FLOAT_EQ(e.cumulative, total);
    EXPECT_EQ(s.materialIds[e.triangle], 2u);
    EXPECT_NEAR(e.probability, e.area * luminance(e.emission) / g.emitterPower, 1e-6f);
    total += e.probability;
  }
  EXPECT_NEAR(total, 1, 1e-6f);
  uint64_t bytes = 0;
  for (const auto& [name, size] : g.memory()) bytes += size;
  EXPECT_GT(bytes, uint64_t{64 * 64 * 4 * 3});

  s.materials[2].emission = vec3(0.0f);
  s.materials[0].emission = s.materials[1].emission = vec3(1.0f);
  s.pointLights.clear();
  updateLights(*device, g, s);
  EXPECT_EQ(g.lightCount, 2u);
  EXPECT_EQ(g.emitterCount, 4u);
  EXPECT_EQ(download<shared::GpuMaterial>(g.materials)[0].flags & shared::kMaterialEmissive, shared::kMaterialEmissive);
}

TEST_F(SceneGpu, EmptySceneUploads) {
  Scene s;
  finishScene(s);
  const GpuScene g = uploadScene(*device, s);
  EXPECT_EQ(g.triangleCount, 0u);
  EXPECT_EQ(g.lightCount, 0u);
  EXPECT_EQ(g.emitterCount, 0u);
  EXPECT_FALSE(g.features.surfaces);
  EXPECT_TRUE(static_cast<bool>(g.lights) && static_cast<bool>(g.emitters) && static_cast<bool>(g.textures));
}

}  // namespace
}  // namespace hl
