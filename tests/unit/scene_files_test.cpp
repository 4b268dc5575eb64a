// The project's own scenes and those over outside meshes: sizes, areas, materials, lights, which way surfaces look.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "engine/core/files.h"
#include "engine/scene/scene_build.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/shapes.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

class SceneFiles : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};
};

double area(const Scene& s, const std::string& material = "") {
  double sum = 0;
  for (size_t t = 0; t < s.triangles(); ++t) {
    if (!material.empty() && s.materials[s.materialIds[t]].name != material) continue;
    const uvec3 i = s.indices[t];
    sum += 0.5 * static_cast<double>(
                     glm::length(glm::cross(s.positions[i.y] - s.positions[i.x], s.positions[i.z] - s.positions[i.x])));
  }
  return sum;
}

/// The volume that the surfaces enclose, positive where they look outward.
double volume(const Scene& s) {
  double sum = 0;
  for (const uvec3 i : s.indices)
    sum += static_cast<double>(glm::dot(s.positions[i.x], glm::cross(s.positions[i.y], s.positions[i.z]))) / 6;
  return sum;
}

void expectSound(const Scene& s) {
  ASSERT_EQ(s.normals.size(), s.positions.size());
  ASSERT_EQ(s.uvs.size(), s.positions.size());
  ASSERT_TRUE(s.lightmapUvs.empty() || s.lightmapUvs.size() == s.positions.size());
  ASSERT_EQ(s.materialIds.size(), s.triangles());
  ASSERT_EQ(s.objectIds.size(), s.triangles());
  EXPECT_FALSE(s.cameras.empty());
  EXPECT_FALSE(s.hash.empty());
  for (size_t t = 0; t < s.triangles(); ++t) {
    const uvec3 i = s.indices[t];
    ASSERT_LT(std::max({i.x, i.y, i.z}), s.positions.size());
    ASSERT_LT(s.materialIds[t], s.materials.size());
    ASSERT_LT(s.objectIds[t], s.objects.size());
  }
  for (const vec3 n : s.normals) ASSERT_NEAR(glm::length(n), 1, 1e-4f);
  for (const Material& m : s.materials) {
    ASSERT_TRUE(m.albedoTexture == kNone || m.albedoTexture < s.textures.size());
    ASSERT_TRUE(m.normalTexture == kNone || m.normalTexture < s.textures.size());
    if (m.albedoTexture == kNone) {
      EXPECT_LE(std::max({m.albedo.x, m.albedo.y, m.albedo.z}), kMaxAlbedo);
    }
  }
}

TEST_F(SceneFiles, CornellBoxHasThePublishedMeasures) {
  const Scene s = loadScene("cornell_box");
  expectSound(s);
  EXPECT_EQ(s.name, "cornell_box");
  EXPECT_EQ(s.triangles(), 38u);
  EXPECT_EQ(s.objects.size(), 8u);
  EXPECT_NEAR(s.bounds.max.x, 0.556f, 1e-6f);
  EXPECT_NEAR(s.bounds.max.y, 0.5488f, 1e-6f);
  EXPECT_NEAR(s.bounds.max.z, 0.5592f, 1e-6f);
  EXPECT_NEAR(area(s, "light"), 0.130 * 0.105, 1e-8);
  EXPECT_NEAR(area(s, "green"), 0.5592 * 0.5488, 1e-7);
  // Floor and ceiling by the shoelace formula; the lamp takes its share of the ceiling.
  const double floor = 0.5 * (552.8 + 549.6) * 559.2e-6, ceiling = 556.0 * 559.2e-6, lamp = 130 * 105e-6;
  double found = 0;
  for (size_t t = 0; t < s.triangles(); ++t) {
    const std::string& name = s.objects[s.objectIds[t]];
    if (name != "floor" && name != "ceiling") continue;
    const uvec3 i = s.indices[t];
    const vec3 doubled = glm::cross(s.positions[i.y] - s.positions[i.x], s.positions[i.z] - s.positions[i.x]);
    EXPECT_EQ(doubled.y > 0, name == "floor");  // both show their front to the inside
    found += 0.5 * static_cast<double>(glm::length(doubled));
  }
  EXPECT_NEAR(found, floor + ceiling - lamp, 1e-6);
  for (const Material& m : s.materials) {
    if (m.name == "white") {
      EXPECT_EQ(m.albedo, vec3(0.725f, 0.71f, 0.68f));
    }
    if (m.name == "red") {
      EXPECT_EQ(m.albedo, vec3(0.63f, 0.065f, 0.05f));
    }
    if (m.name == "green") {
      EXPECT_EQ(m.albedo, vec3(0.14f, 0.45f, 0.091f));
    }
    EXPECT_EQ(m.emission, m.name == "light" ? vec3(17, 12, 4) : vec3(0.0f));
    EXPECT_FALSE(m.twoSided);
  }
  const SceneFeatures f = sceneFeatures(s);
  EXPECT_TRUE(f.surfaces && f.emissive && f.anyLight());
  EXPECT_EQ(f.emissiveTriangles, 2u);
  EXPECT_FALSE(f.pointLights || f.spotLights || f.directionalLights || f.sky || f.alphaTested || f.albedoTextures ||
               f.normalMaps || f.twoSided);
  EXPECT_EQ(s.cameras[0].name, "front");
  EXPECT_NEAR(s.cameras[0].verticalFov, 2 * std::atan(0.0125 / 0.035), 1e-5);
  EXPECT_GE(s.regions.size(), 3u);
}

TEST_F(SceneFiles, CornellBlocksLookOutward) {
  const Scene s = loadScene("cornell_box");
  for (const char* block : {"short_block", "tall_block"}) {
    vec3 centre(0.0f);
    float n = 0;
    for (size_t t = 0; t < s.triangles(); ++t)
      if (s.objects[s.objectIds[t]] == block)
        for (const uint32_t v : {s.indices[t].x, s.indices[t].y, s.indices[t].z}) centre += s.positions[v], n += 1;
    centre /= n;
    for (size_t t = 0; t < s.triangles(); ++t) {
      if (s.objects[s.objectIds[t]] != block) continue;
      const uvec3 i = s.indices[t];
      const vec3 out = glm::cross(s.positions[i.y] - s.positions[i.x], s.positions[i.z] - s.positions[i.x]);
      EXPECT_GT(glm::dot(out, s.positions[i.x] - centre), 0);
    }
  }
}

struct Enclosure {
  const char* name;
  double area, tolerance, volume;
  float albedo, emission;
};

TEST_F(SceneFiles, EnclosuresAreClosedAndLookInward) {
  for (const Enclosure& e :
       {Enclosure{"furnace_box_050", 24, 1e-6, -8, 0.5f, 1}, Enclosure{"furnace_box_080", 24, 1e-6, -8, 0.8f, 1},
        Enclosure{"furnace_box_090", 24, 1e-6, -8, 0.9f, 1},
        Enclosure{"point_light_cube", 600, 1e-4, -1000, 2 / 3.0f, 0},
        Enclosure{"small_emitter_box", 96, 1e-5, -64, 0.5f, 0}}) {
    const Scene s = loadScene(e.name);
    SCOPED_TRACE(e.name);
    expectSound(s);
    EXPECT_NEAR(area(s), e.area, e.tolerance);
    EXPECT_NEAR(volume(s), e.volume, 1e-4 * std::abs(e.volume));
    for (const Material& m : s.materials) {
      EXPECT_NEAR(m.albedo.x, e.albedo, 1e-6f);
      if (m.name != "lamp") {
        EXPECT_EQ(m.emission, vec3(e.emission));
      }
    }
    EXPECT_TRUE(sceneFeatures(s).anyLight());
    EXPECT_FALSE(s.lightmapUvs.empty());
  }
}

TEST_F(SceneFiles, SpheresAreCloseToSpheres) {
  const double pi = 3.14159265358979;
  for (const char* name : {"furnace_sphere_080", "light_sphere_080"}) {
    const Scene s = loadScene(name);
    SCOPED_TRACE(name);
    expectSound(s);
    EXPECT_NEAR(area(s), 4 * pi, 4 * pi * 2e-3);
    EXPECT_LT(area(s), 4 * pi);
    EXPECT_NEAR(volume(s), -4 * pi / 3, 4 * pi / 3 * 3e-3);
    EXPECT_NEAR(s.materials[0].albedo.x, 0.8f, 1e-6f);
  }
  EXPECT_EQ(loadScene("furnace_sphere_080").triangles(), 20u * 16 * 16);
  const Scene light = loadScene("light_sphere_080");
  ASSERT_EQ(light.pointLights.size(), 1u);
  EXPECT_GT(glm::length(light.pointLights[0].position), 0.3f);  // off the centre, on purpose
  // What scenes/README.md and the file say of the facets: rho Phi / (A (1 - rho)) stays within 1e-3 of 4.
  EXPECT_NEAR(0.8 * 4 * pi / (area(light) * 0.2), 4.0, 4e-3);
}

TEST_F(SceneFiles, QuarterBlockerAndSmallEmitter) {
  const Scene q = loadScene("quarter_blocker");
  expectSound(q);
  EXPECT_NEAR(area(q, "receiver"), 1, 1e-6);
  EXPECT_NEAR(area(q, "emitter"), 1, 1e-6);
  EXPECT_NEAR(area(q, "blocker"), 0.25, 1e-6);
  const Scene s = loadScene("small_emitter_box");
  EXPECT_NEAR(area(s, "lamp"), 0.01, 1e-7);
  for (const Material& m : s.materials)
    if (m.name == "lamp") {
      EXPECT_NEAR(static_cast<double>(m.emission.x) * 3.14159265358979 * area(s, "lamp"), 10000, 1);
    }
}

TEST_F(SceneFiles, ShapeChartsDoNotOverlapAndKeepTheirMargin) {
  for (const char* name : {"furnace_box_050", "furnace_sphere_080", "small_emitter_box", "quarter_blocker"}) {
    const Scene s = loadScene(name);
    SCOPED_TRACE(name);
    double covered = 0;
    for (const uvec3 i : s.indices) {
      const vec2 a = s.lightmapUvs[i.y] - s.lightmapUvs[i.x], b = s.lightmapUvs[i.z] - s.lightmapUvs[i.x];
      covered += 0.5 * std::abs(static_cast<double>(a.x * b.y - a.y * b.x));
    }
    for (const vec2 uv : s.lightmapUvs) ASSERT_TRUE(uv.x > 0 && uv.x < 1 && uv.y > 0 && uv.y < 1);
    // Rasterised: each sample lies in one chart at most.
    constexpr int n = 192;
    std::vector<int> hits(n * n, 0);
    for (const uvec3 i : s.indices) {
      const vec2 p = s.lightmapUvs[i.x], q = s.lightmapUvs[i.y], r = s.lightmapUvs[i.z];
      const vec2 low = glm::min(p, glm::min(q, r)) * static_cast<float>(n),
                 high = glm::max(p, glm::max(q, r)) * static_cast<float>(n);
      for (int y = static_cast<int>(low.y); y <= static_cast<int>(high.y); ++y)
        for (int x = static_cast<int>(low.x); x <= static_cast<int>(high.x); ++x) {
          // Off the grid's own lines, so that no sample falls on an edge.
          const vec2 at =
              (vec2(static_cast<float>(x), static_cast<float>(y)) + vec2(0.5317f, 0.4691f)) / static_cast<float>(n);
          const auto side = [&](vec2 a, vec2 b) { return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x); };
          const float u = side(p, q), v = side(q, r), w = side(r, p);
          if ((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0)) ++hits[static_cast<size_t>(y * n + x)];
        }
    }
    int inside = 0;
    for (const int h : hits) {
      EXPECT_LE(h, 1);
      inside += h;
    }
    EXPECT_NEAR(inside, covered * n * n, 0.02 * covered * n * n);
  }
}

TEST_F(SceneFiles, ShapesOfEachKind) {
  Scene s;
  s.materials.resize(1);
  Shape box;
  box.type = ShapeType::Box, box.subdivisions = 3, box.min = vec3(1, 2, 3), box.max = vec3(2, 4, 6);
  appendShapes(s, {box}, false, [](const std::string&) { return 0u; });
  EXPECT_EQ(s.triangles(), 6u * 9 * 2);
  EXPECT_NEAR(area(s), 2 * (2 + 3 + 6), 1e-5);
  EXPECT_NEAR(volume(s), 6, 1e-5);
  for (const bool inward : {false, true})
    for (const ShapeType type : {ShapeType::UvSphere, ShapeType::Icosphere}) {
      Scene t;
      t.materials.resize(1);
      Shape sphere;
      sphere.type = type, sphere.inward = inward, sphere.smooth = true, sphere.radius = 2, sphere.subdivisions = 24,
      sphere.centre = vec3(0.0f);
      appendShapes(t, {sphere}, true, [](const std::string&) { return 0u; });
      EXPECT_EQ(t.triangles(), type == ShapeType::Icosphere ? 20u * 24 * 24 : 2u * 48 * 23);
      EXPECT_NEAR(volume(t), (inward ? -1 : 1) * 4 * 3.14159265 / 3 * 8, 0.4);
      for (size_t v = 0; v < t.positions.size(); ++v)
        EXPECT_NEAR(glm::dot(t.normals[v], t.positions[v]), inward ? -2 : 2, 1e-5f);
    }
}

TEST_F(SceneFiles, SponzaIsInMetresAndShowsItsFronts) {
  if (!std::getenv("HALFLIGHT_SCENES")) GTEST_SKIP() << "HALFLIGHT_SCENES is not set: Sponza is not looked for";
  const Scene s = loadScene("sponza");
  expectSound(s);
  EXPECT_EQ(s.triangles() + s.report.degenerateTriangles, 262267u);
  EXPECT_LE(s.report.degenerateTriangles, 2u);
  EXPECT_EQ(s.materials.size(), 25u);
  EXPECT_EQ(s.report.missingTextures, 0u);
  EXPECT_TRUE(s.report.warnings.empty());
  const vec3 size = s.bounds.max - s.bounds.min;
  EXPECT_NEAR(size.x, 37.2f, 0.2f);
  EXPECT_NEAR(size.y, 15.6f, 0.2f);
  const SceneFeatures f = sceneFeatures(s);
  EXPECT_TRUE(f.alphaTested && f.albedoTextures && f.normalMaps && f.twoSided && f.directionalLights && f.sky);
  EXPECT_FALSE(f.emissive || f.pointLights || f.spotLights);
  for (const Material& m : s.materials) {
    const bool cutOut = m.name == "leaf" || m.name == "chain" || m.name == "Material__57";
    EXPECT_EQ(m.alphaCutoff > 0, cutOut) << m.name;
    EXPECT_EQ(m.twoSided, cutOut) << m.name;
    if (m.name == "bricks" || m.name == "leaf") {
      EXPECT_NE(m.normalTexture, kNone) << m.name;
    }
    if (m.name == "floor") {
      EXPECT_EQ(m.normalTexture, kNone);
    }
  }
  EXPECT_GE(s.cameras.size(), 3u);
  EXPECT_EQ(loadScene("sponza").hash, s.hash);  // now from the cache
}

TEST_F(SceneFiles, OutsideCornellBoxesShowTheirFrontsToTheInside) {
  if (!std::getenv("HALFLIGHT_SCENES")) GTEST_SKIP() << "HALFLIGHT_SCENES is not set: the boxes are not looked for";
  for (const char* name : {"cornell_original", "cornell_sphere"}) {
    const Scene s = loadScene(name);
    SCOPED_TRACE(name);
    expectSound(s);
    EXPECT_TRUE(s.report.warnings.empty());
    EXPECT_EQ(sceneFeatures(s).emissiveTriangles, 2u);
    const vec3 centre = s.bounds.centre();
    for (size_t t = 0; t < s.triangles(); ++t) {
      const std::string& m = s.materials[s.materialIds[t]].name;
      if (m != "floor" && m != "ceiling" && m != "light" && m.find("Wall") == std::string::npos) continue;
      const uvec3 i = s.indices[t];
      const vec3 front = glm::cross(s.positions[i.y] - s.positions[i.x], s.positions[i.z] - s.positions[i.x]);
      EXPECT_GT(glm::dot(front, centre - s.positions[i.x]), 0) << m;
    }
  }
}

TEST_F(SceneFiles, SmallestScenesLoad) {
  const std::filesystem::path data = homeFolder() / "tests/data";
  const Scene none = loadScene((data / "no_surfaces.json").string());
  expectSound(none);
  EXPECT_FALSE(sceneFeatures(none).surfaces);
  EXPECT_TRUE(none.bounds.empty());
  EXPECT_TRUE(sceneFeatures(none).sky);
  const Scene one = loadScene((data / "one_triangle.json").string());
  expectSound(one);
  EXPECT_EQ(one.triangles(), 1u);
  const Scene dark = loadScene((data / "no_lights.json").string());
  expectSound(dark);
  EXPECT_FALSE(sceneFeatures(dark).anyLight());
}

TEST_F(SceneFiles, BareMeshGetsACameraAndALight) {
  const Scene s = loadScene((homeFolder() / "tests/data/one_triangle.obj").string());
  EXPECT_TRUE(sceneFeatures(s).directionalLights && sceneFeatures(s).sky);
  ASSERT_EQ(s.cameras.size(), 1u);
  // Every corner is inside the picture, for a square one.
  const Camera& c = s.cameras[0];
  const vec3 forward = glm::normalize(c.target - c.position), right = glm::normalize(glm::cross(forward, c.up)),
             up = glm::cross(right, forward);
  for (const vec3 p : s.positions) {
    const vec3 d = p - c.position;
    const float limit = std::tan(0.5f * c.verticalFov) * glm::dot(d, forward);
    EXPECT_GT(limit, 0);
    EXPECT_LT(std::abs(glm::dot(d, right)), limit);
    EXPECT_LT(std::abs(glm::dot(d, up)), limit);
  }
}

TEST_F(SceneFiles, CameraOfARoomIsInsideIt) {
  Scene s = loadScene("furnace_box_050");
  const Camera c = sensibleCamera(s);
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT(c.position[k], s.bounds.min[k]);
    EXPECT_LT(c.position[k], s.bounds.max[k]);
  }
}

TEST_F(SceneFiles, FarScenesAreRecentred) {
  for (const float far : {1e4f, 1e6f}) {
    Scene s = loadScene("cornell_box");
    const Scene near = s;
    const vec3 shift(far, -far, 0.5f * far);
    for (vec3& p : s.positions) p += shift;
    s.cameras[0].position += shift, s.cameras[0].target += shift;
    s.pointLights.push_back({"lamp", shift, vec3(1.0f)});
    finishScene(s);
    EXPECT_LT(glm::length(s.bounds.centre()), s.bounds.diagonal());
    EXPECT_GT(glm::length(s.report.recentred), 0.5f * far);
    const float bits = far * 2e-7f;  // what a float keeps at that distance
    EXPECT_NEAR(glm::length(s.pointLights[0].position + s.report.recentred - shift), 0, bits);
    EXPECT_NEAR(glm::distance(s.cameras[0].position, s.pointLights[0].position), glm::length(near.cameras[0].position),
                4 * bits);
  }
  EXPECT_EQ(loadScene("cornell_box").report.recentred, vec3(0.0f));
}

TEST_F(SceneFiles, HashFollowsLightTransportAlone) {
  const Scene a = loadScene("cornell_box");
  Scene b = a;
  b.cameras.clear(), b.regions.clear(), b.materials[0].name = "other", b.name = "other";
  EXPECT_EQ(sceneContentHash(b), a.hash);
  const auto differs = [&](auto&& change) {
    Scene c = a;
    change(c);
    EXPECT_NE(sceneContentHash(c), a.hash);
  };
  differs([](Scene& s) { s.positions[0].x += 1e-6f; });
  differs([](Scene& s) { s.materials[0].emission.x += 1; });
  differs([](Scene& s) { s.materials[0].twoSided = true; });
  differs([](Scene& s) { s.sky.x = 1; });
  differs([](Scene& s) { s.pointLights.push_back({}); });
  differs([](Scene& s) { s.materialIds[0] ^= 1; });
}

TEST_F(SceneFiles, AlbedoIsCappedAndCounted) {
  test::writePng(folder / "white.png", 2, 2, 3, [](int, int, int) { return 255; });
  test::writePng(folder / "grey.png", 2, 2, 3, [](int, int, int) { return 100; });
  test::writeText(
      folder / "a.mtl",
      "newmtl plain\nKd 1 0.5 1\nnewmtl white\nKd 1 1 1\nmap_Kd white.png\nnewmtl grey\nKd 1 1 1\nmap_Kd grey.png\n");
  test::writeText(folder / "a.obj",
                  "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl plain\nf 1/1 2/1 3/1\nusemtl white\nf 1/1 "
                  "2/1 3/1\nusemtl grey\nf 1/1 2/1 3/1\n");
  const Scene s = loadScene((folder / "a.obj").string());
  EXPECT_EQ(s.report.cappedAlbedo, 2u);  // not the grey one: its product stays below
  EXPECT_EQ(s.materials[0].albedo, vec3(kMaxAlbedo, 0.5f, kMaxAlbedo));
  EXPECT_EQ(s.materials[2].albedo, vec3(1.0f));
}

TEST_F(SceneFiles, SavedSceneReadsBack) {
  std::filesystem::copy(homeFolder() / "scenes", folder / "scenes");
  Scene s = loadScene((folder / "scenes/cornell_box.json").string());
  s.sky = vec3(0.1f, 0.2f, 0.3f);
  s.pointLights.push_back({"bulb", vec3(0.1f, 0.2f, 0.3f), vec3(1, 2, 3)});
  s.spotLights.push_back({"spot", vec3(0.3f), glm::normalize(vec3(1, -2, 0.5f)), vec3(4.0f), 0.2f, 0.4f});
  s.directionalLights.push_back({"sun", glm::normalize(vec3(0.3f, -1, 0)), vec3(2.0f)});
  s.cameras[0].position.x += 0.125f;
  for (Material& m : s.materials)
    if (m.name == "light") m.emission = vec3(1, 2, 3);
  test::writeText(folder / "scenes/edited.json", sceneJson(s));
  const Scene back = loadScene((folder / "scenes/edited.json").string());
  EXPECT_EQ(back.triangles(), s.triangles());
  EXPECT_EQ(back.sky, s.sky);
  ASSERT_EQ(back.pointLights.size(), 1u);
  EXPECT_EQ(back.pointLights[0].position, s.pointLights[0].position);
  ASSERT_EQ(back.spotLights.size(), 1u);
  EXPECT_NEAR(back.spotLights[0].innerAngle, 0.2f, 1e-6f);
  EXPECT_NEAR(glm::dot(back.spotLights[0].direction, s.spotLights[0].direction), 1, 1e-6f);
  ASSERT_EQ(back.directionalLights.size(), 1u);
  EXPECT_EQ(back.cameras[0].position, s.cameras[0].position);
  EXPECT_NEAR(back.cameras[0].verticalFov, s.cameras[0].verticalFov, 1e-6f);
  EXPECT_EQ(back.regions.size(), s.regions.size());
  for (const Material& m : back.materials)
    if (m.name == "light") {
      EXPECT_EQ(m.emission, vec3(1, 2, 3));
    }
}

TEST_F(SceneFiles, ListingTellsWhatIsMissing) {
  const test::EnvironmentVariable scenes("HALFLIGHT_SCENES", (folder / "nothing").string());
  const std::vector<SceneListing> all = listScenes();
  bool cornell = false, sponza = false;
  for (const SceneListing& s : all) {
    if (s.id == "cornell_box") {
      cornell = true;
      EXPECT_TRUE(s.available);
      EXPECT_EQ(s.label, "Cornell box");
    }
    if (s.id == "sponza") {
      sponza = true;
      EXPECT_FALSE(s.available);
      EXPECT_NE(s.missing.find("casual-effects.com"), std::string::npos) << s.missing;
    }
  }
  EXPECT_TRUE(cornell && sponza);
  try {
    loadScene("sponza");
    FAIL() << "loaded without its mesh";
  } catch (const Error& e) {
    EXPECT_EQ(e.exitCode(), 2);
    EXPECT_NE(std::string(e.what()).find("get it from"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace hl
