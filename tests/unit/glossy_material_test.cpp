// Glossy materials: what scene files say of them, what is refused or capped, and that they outlive every form a scene is stored in.
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_pack.h"
#include "shaders/shared/ggx.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

class GlossyMaterial : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};

  /// A floor of that material.
  Scene load(const std::string& material) {
    test::writeText(folder / "scene.json", R"({"version": 1, "shapes": [{"type": "quad", "material": "floor", "corners": [[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]}],
      "materials": {"floor": )" + material + "}}");
    return loadScene((folder / "scene.json").string());
  }
  void expectRefusal(const std::string& material, const std::string& place, const std::string& right) {
    try {
      load(material);
      ADD_FAILURE() << material << " was taken";
    } catch (const Error& e) {
      const std::string what = e.what();
      EXPECT_NE(what.find(place), std::string::npos) << what;
      EXPECT_NE(what.find(right), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
  }
};

TEST_F(GlossyMaterial, IsRead) {
  const Scene s = load(R"({"albedo": 0.2, "specular": [0.3, 0.4, 0.5], "roughness": 0.25})");
  EXPECT_EQ(s.materials[0].specular, vec3(0.3f, 0.4f, 0.5f));
  EXPECT_EQ(s.materials[0].roughness, 0.25f);
  EXPECT_TRUE(sceneFeatures(s).glossySurfaces);
  EXPECT_EQ(s.report.cappedSpecular, 0u);
  const Scene grey = load(R"({"albedo": 0.2, "specular": 0.8})");
  EXPECT_EQ(grey.materials[0].specular, vec3(0.8f)) << "0.2 + 0.8 is all there is, and no more";
  EXPECT_EQ(grey.materials[0].roughness, kDefaultRoughness);
  EXPECT_EQ(grey.report.cappedSpecular, 0u);
  EXPECT_EQ(load(R"({"specular": 0.1, "roughness": 0.05})").materials[0].roughness, shared::kMinRoughness) << "the bound itself";
  EXPECT_FALSE(sceneFeatures(load(R"({"albedo": 0.2, "roughness": 0.25})")).glossySurfaces) << "without reflectance there is no lobe";
}

TEST_F(GlossyMaterial, IsRefusedInOneLine) {
  expectRefusal(R"({"specular": 1.5})", "materials.floor.specular", "[0, 1]");
  expectRefusal(R"({"specular": [0.5, -0.1, 0]})", "materials.floor.specular[1]", "[0, 1]");
  expectRefusal(R"({"specular": "shiny"})", "materials.floor.specular", "three numbers");
  expectRefusal(R"({"specular": 0.5, "roughness": 0})", "materials.floor.roughness", "[0.05, 1]");
  expectRefusal(R"({"specular": 0.5, "roughness": 2})", "materials.floor.roughness", ", 1]");
  expectRefusal(R"({"speculr": 0.5})", "speculr", "specular");
}

TEST_F(GlossyMaterial, ReflectsNoMoreThanArrives) {
  const Scene s = load(R"({"albedo": [0.5, 0.2, 0.99], "specular": [0.6, 0.6, 0.6]})");
  EXPECT_EQ(s.report.cappedSpecular, 1u);
  EXPECT_NEAR(s.materials[0].specular.x, 0.5f, 1e-6f);
  EXPECT_EQ(s.materials[0].specular.y, 0.6f);
  EXPECT_NEAR(s.materials[0].specular.z, 0.01f, 1e-6f);
}

TEST_F(GlossyMaterial, IsPartOfTheHashOnlyWhereItIsGlossy) {
  const std::string diffuse = load(R"({"albedo": 0.2})").hash, rough = load(R"({"albedo": 0.2, "roughness": 0.25})").hash;
  EXPECT_EQ(diffuse, rough) << "what has no lobe has no roughness";
  const std::string glossy = load(R"({"albedo": 0.2, "specular": 0.3})").hash;
  EXPECT_NE(glossy, diffuse);
  EXPECT_NE(load(R"({"albedo": 0.2, "specular": 0.4})").hash, glossy);
  EXPECT_NE(load(R"({"albedo": 0.2, "specular": 0.3, "roughness": 0.25})").hash, glossy);
}

TEST_F(GlossyMaterial, OutlivesPackingAndSaving) {
  Scene s = load(R"({"albedo": 0.2, "specular": [0.3, 0.4, 0.5], "roughness": 0.25})");
  const Scene packed = unpackScene(packScene(s));
  EXPECT_EQ(packed.materials[0].specular, s.materials[0].specular);
  EXPECT_EQ(packed.materials[0].roughness, s.materials[0].roughness);
  EXPECT_EQ(packed.hash, s.hash);
  s.materials[0].specular = vec3(0.1f, 0.2f, 0.3f), s.materials[0].roughness = 0.1f;
  const std::string text = sceneJson(s);
  test::writeText(folder / "scene.json", text);
  const Scene again = loadScene((folder / "scene.json").string());
  EXPECT_EQ(again.materials[0].specular, s.materials[0].specular);
  EXPECT_EQ(again.materials[0].roughness, s.materials[0].roughness);
}

TEST_F(GlossyMaterial, OfGltfFilesIsNotReadAndSaidSo) {
  test::SquareGltf square;
  test::writeText(folder / "plain.gltf", square.embedded());
  EXPECT_TRUE(loadScene((folder / "plain.gltf").string()).report.warnings.empty());
  square.material = R"({"name": "paint", "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0.2}})";
  test::writeText(folder / "metal.gltf", square.embedded());
  const Scene s = loadScene((folder / "metal.gltf").string());
  ASSERT_EQ(s.report.warnings.size(), 1u);
  EXPECT_NE(s.report.warnings[0].find("metallic and roughness of 1 material are not read"), std::string::npos) << s.report.warnings[0];
  EXPECT_FALSE(sceneFeatures(s).glossySurfaces);
}

TEST_F(GlossyMaterial, TheGlossyBoxHasOne) {
  const Scene s = loadScene("glossy_box");
  EXPECT_TRUE(sceneFeatures(s).glossySurfaces);
  EXPECT_EQ(s.report.cappedSpecular, 0u);
  EXPECT_TRUE(s.report.warnings.empty());
}

}  // namespace
}  // namespace hl
