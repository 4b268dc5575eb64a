// Scene files: what is read, and what is refused with file, place and reason in one line.
#include "engine/scene/scene_description.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/scene/scene_file.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

void expectError(const std::function<void()>& f, const std::vector<std::string>& words) {
  try {
    f();
    ADD_FAILURE() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.exitCode(), 2);
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    for (const std::string& word : words)
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " in: " << e.what();
  }
}

void expectRefused(const std::string& json, std::vector<std::string> words) {
  words.push_back("room.json");
  SCOPED_TRACE(json);
  expectError([&] { parseSceneDescription(json, "room.json"); }, words);
}

TEST(SceneDescription, ReadsEverything) {
  const SceneDescription d = parseSceneDescription(R"({
    "version": 1, "label": "A room", "comment": ["two", "lines"], "lightmap_uvs": true,
    "shapes": [
      {"type": "box", "name": "room", "min": [0, 0, 0], "max": [1, 2, 3], "facing": "inward", "subdivisions": 4, "material": "wall",
       "faces": ["-x", "+y"], "face_materials": {"-x": "red"}},
      {"type": "quad", "material": "red", "corners": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]},
      {"type": "uv_sphere", "material": "red", "centre": [1, 2, 3], "radius": 0.5, "smooth": true},
      {"type": "icosphere", "material": "red", "centre": [1, 2, 3], "subdivisions": 3}],
    "materials": {"wall": {"albedo": 0.5}, "red": {"albedo": [0.5, 0, 0], "emission": [1, 2, 3], "two_sided": true, "alpha_cutoff": 0.25}},
    "lights": [{"type": "point", "name": "a", "position": [1, 2, 3], "intensity": 5},
               {"type": "spot", "position": [0, 1, 0], "direction": [0, -2, 0], "intensity": [1, 2, 3], "inner_degrees": 10, "outer_degrees": 20},
               {"type": "directional", "direction": [0, -1, 0], "irradiance": 3}],
    "sky": [0.1, 0.2, 0.3],
    "cameras": [{"name": "c", "position": [0, 1, 5], "target": [0, 1, 0], "vertical_fov_degrees": 90}],
    "regions": [{"name": "r", "x": 0.1, "y": 0.2, "width": 0.3, "height": 0.4}]})",
                                                   "room.json");
  EXPECT_EQ(d.label, "A room");
  ASSERT_EQ(d.shapes.size(), 4u);
  EXPECT_TRUE(d.shapes[0].inward);
  EXPECT_EQ(d.shapes[0].faces, (std::vector<std::string>{"-x", "+y"}));
  EXPECT_EQ(d.shapes[0].faceMaterials.at("-x"), "red");
  EXPECT_EQ(d.shapes[3].subdivisions, 3);
  ASSERT_EQ(d.materials.size(), 2u);
  ASSERT_EQ(d.pointLights.size(), 1u);
  EXPECT_EQ(d.pointLights[0].intensity, vec3(5.0f));
  ASSERT_EQ(d.spotLights.size(), 1u);
  EXPECT_EQ(d.spotLights[0].direction, vec3(0, -1, 0));
  EXPECT_NEAR(d.spotLights[0].innerAngle, 0.17453293f, 1e-6f);
  ASSERT_EQ(d.directionalLights.size(), 1u);
  EXPECT_EQ(d.sky, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_NEAR(d.cameras[0].verticalFov, 1.5707964f, 1e-6f);
  EXPECT_EQ(d.regions[0].height, 0.4f);
}

TEST(SceneDescription, NotJson) {
  expectRefused("", {"not JSON"});
  expectRefused("{\"version\": 1,\n \"sky\": }", {"not JSON", "line 2"});
  expectRefused("[1, 2]", {"an object is wanted", "array"});
  expectRefused("{\"version\": 1} x", {"not JSON"});
  expectRefused("\xff\xfe\x01", {"not JSON"});
}

TEST(SceneDescription, WrongTypes) {
  expectRefused(R"({"version": "1"})", {"version", "whole number", "string"});
  expectRefused(R"({"label": 3})", {"label", "a string is wanted"});
  expectRefused(R"({"sky": "blue"})", {"sky", "three numbers"});
  expectRefused(R"({"sky": [1, 2]})", {"sky", "2 values"});
  expectRefused(R"({"sky": [1, "2", 3]})", {"sky[1]", "a number is wanted", "string"});
  expectRefused(R"({"lights": {}})", {"lights", "an array is wanted"});
  expectRefused(R"({"lights": [3]})", {"lights[0]", "an object is wanted"});
  expectRefused(R"({"mesh": 3})", {"mesh", "an object is wanted"});
  expectRefused(R"({"lightmap_uvs": 1})", {"lightmap_uvs", "true or false"});
  expectRefused(R"({"materials": {"a": {"albedo": null}}})", {"materials.a.albedo", "null"});
}

TEST(SceneDescription, UnknownKeysNameTheNearest) {
  expectRefused(R"({"camera": []})", {"unknown key 'camera'", "'cameras'"});
  expectRefused(R"({"materials": {"a": {"emision": 1}}})", {"materials.a", "unknown key 'emision'", "'emission'"});
  expectRefused(R"({"lights": [{"type": "point", "position": [0, 0, 0], "intensity": 1, "colour": [1, 1, 1]}]})",
                {"lights[0]", "unknown key 'colour'"});
  expectRefused(R"({"lights": [{"type": "area"}]})", {"lights[0].type", "'area'", "point, spot, directional"});
  expectRefused(R"({"shapes": [{"type": "cone", "material": "a"}]})", {"shapes[0].type", "'cone'", "quad, box"});
}

TEST(SceneDescription, ValuesOutOfRange) {
  expectRefused(R"({"version": 2})", {"version", "2"});
  expectRefused(R"({"version": 0})", {"version", "out of range"});
  expectRefused(R"({"sky": [1, -1, 1]})", {"sky[1]", "-1", "out of range"});
  expectRefused(R"({"materials": {"a": {"albedo": 1.5}}})", {"materials.a.albedo", "1.5", "[0, 1]"});
  expectRefused(R"({"mesh": {"file": "a.obj", "v_down": 1}})", {"mesh.v_down"});
  expectRefused(R"({"mesh": {"file": "a.obj", "import_scale": 0}})", {"mesh.import_scale", "out of range"});
  expectRefused(R"({"sky": 1e999})", {"room.json"});
  expectRefused(R"({"cameras": [{"name": "a", "position": [0, 0, 0], "target": [0, 0, 0]}]})",
                {"cameras[0].target", "differ"});
  expectRefused(R"({"cameras": [{"name": "a", "position": [0, 0, 0], "target": [0, 5, 0]}]})", {"cameras[0].up"});
  expectRefused(
      R"({"cameras": [{"name": "a", "position": [0, 0, 0], "target": [0, 0, 1], "vertical_fov_degrees": 180}]})",
      {"vertical_fov_degrees", "180"});
  expectRefused(R"({"regions": [{"name": "a", "x": 0.6, "width": 0.6}]})", {"regions[0]", "beyond the image"});
  expectRefused(R"({"lights": [{"type": "directional", "direction": [0, 0, 0], "irradiance": 1}]})",
                {"lights[0].direction", "nowhere"});
  expectRefused(
      R"({"lights": [{"type": "spot", "position": [0, 0, 0], "direction": [0, 1, 0], "intensity": 1, "inner_degrees": 40}]})",
      {"inner_degrees", "outer_degrees"});
  expectRefused(R"({"shapes": [{"type": "box", "material": "a", "min": [0, 0, 0], "max": [1, 0, 1]}]})",
                {"shapes[0].max"});
  expectRefused(R"({"shapes": [{"type": "box", "material": "a", "min": [0, 0, 0], "max": [1, 1, 1], "faces": ["x"]}]})",
                {"shapes[0].faces", "'x'"});
  expectRefused(R"({"shapes": [{"type": "quad", "material": "a", "corners": [[0, 0, 0]]}]})",
                {"shapes[0].corners", "4 points"});
}

TEST(SceneDescription, MissingKeys) {
  expectRefused(R"({"mesh": {}})", {"mesh", "'file' is missing"});
  expectRefused(R"({"lights": [{"type": "point", "intensity": 1}]})", {"lights[0]", "'position' is missing"});
  expectRefused(R"({"shapes": [{"type": "box", "min": [0, 0, 0], "max": [1, 1, 1]}]})",
                {"shapes[0]", "'material' is missing"});
  expectRefused(R"({"cameras": [{"position": [0, 0, 0], "target": [0, 0, 1]}]})", {"cameras[0]", "'name' is missing"});
}

class SceneLoading : public testing::Test {
 protected:
  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};
};

TEST_F(SceneLoading, NamesThatAreNotThere) {
  expectError([] { loadScene("cornel_box"); }, {"'cornel_box'", "did you mean 'cornell_box'"});
  expectError([] { loadScene(""); }, {"empty"});
  expectError([] { loadScene("nowhere/room.json"); }, {"nowhere/room.json", "no such file"});
  expectError([&] { loadScene((folder / "a.obj").string()); }, {"a.obj", "no such file"});
  test::writeText(folder / "a.fbx", "x");
  expectError([&] { loadScene((folder / "a.fbx").string()); }, {"a.fbx", ".obj, .gltf, .glb"});
}

TEST_F(SceneLoading, MaterialsThatNobodyHas) {
  test::writeText(
      folder / "room.json",
      R"({"shapes": [{"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "material": "wall"}], "materials": {"wal": {}}})");
  expectError([&] { loadScene((folder / "room.json").string()); }, {"room.json", "materials.wal", "'wall'"});
  test::writeText(folder / "room.json",
                  R"({"shapes": [{"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "material": "wall"}]})");
  expectError([&] { loadScene((folder / "room.json").string()); }, {"room.json", "'wall'", "not under 'materials'"});
}

TEST_F(SceneLoading, MeshIsFoundBesideAndChangedByTheScene) {
  test::writeText(folder / "square.obj", test::kSquareObj);
  test::writeText(folder / "square.mtl", "newmtl paint\nKd 0.5 0.5 0.5\n");
  test::writeText(
      folder / "room.json",
      R"({"mesh": {"file": "square.obj", "import_scale": 2}, "materials": {"paint": {"emission": 3, "two_sided": true}}})");
  for (const Scene& s : {loadScene((folder / "room.json").string()), loadScene("room", nullptr, folder.path())}) {
    EXPECT_EQ(s.bounds.max, vec3(2, 2, 0));
    EXPECT_EQ(s.materials[0].albedo, vec3(0.5f));
    EXPECT_EQ(s.materials[0].emission, vec3(3.0f));
    EXPECT_TRUE(s.materials[0].twoSided);
    EXPECT_FALSE(sceneFeatures(s).directionalLights);  // a scene file says itself what lights it has
  }
  test::writeText(folder / "room.json", R"({"mesh": {"file": "gone.obj", "obtain": "the shelf"}})");
  expectError([&] { loadScene((folder / "room.json").string()); },
              {"room.json", "'gone.obj' is missing", "get it from the shelf"});
}

}  // namespace
}  // namespace hl
