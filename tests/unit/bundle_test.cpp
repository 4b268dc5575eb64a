// Bundles: a scene comes out as it went in, is found by its name, and what is wrong with a file is said in one line.
#include <gtest/gtest.h>

#include "engine/core/files.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/open_target.h"
#include "engine/reference/reference_state.h"
#include "engine/scene/scene_file.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

class BundleTest : public testing::Test {
 protected:
  BundleTest() {
    test::writeText(folder / "square.obj", test::kSquareObj);
    test::writeText(folder / "square.mtl", "newmtl paint\nKd 0.5 0.4 0.3\nmap_Kd t.png\n");
    test::writePng(folder / "t.png", 4, 2, 3, [](int x, int y, int c) { return 20 * x + 10 * y + c; });
    test::writeText(folder / "room.json", R"({"version": 1, "mesh": "square.obj",
      "lights": [{"type": "point", "name": "lamp", "position": [0, 1, 2], "intensity": [3, 2, 1]},
                 {"type": "spot", "name": "spot", "position": [1, 1, 2], "direction": [0, 0, -1], "intensity": [3, 2, 1],
                  "inner_degrees": 10, "outer_degrees": 20},
                 {"type": "directional", "name": "sun", "direction": [0, 0, -1], "irradiance": [1, 2, 3]}],
      "sky": [0.1, 0.2, 0.3], "regions": [{"name": "corner", "x": 0, "y": 0, "width": 0.5, "height": 0.5}],
      "cameras": [{"name": "front", "position": [0.5, 0.5, 3], "target": [0.5, 0.5, 0]}]})");
    scene = loadScene((folder / "room.json").string());
    preset.scene = "room", preset.technique = "none", preset.width = 32, preset.height = 18;
  }
  void write() { writeBundle(file, {preset, {{"room", &scene}}, cached}); }
  std::string messageOf(const std::function<void()>& f) {
    try {
      f();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::BadInput);
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
  }

  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};
  const std::filesystem::path file = folder / "packed/room.hlb";
  Scene scene;
  Preset preset;
  std::vector<std::filesystem::path> cached;
};

TEST_F(BundleTest, SceneComesBackWhole) {
  std::filesystem::create_directories(file.parent_path());
  write();
  for (const char* gone : {"square.obj", "room.json", "t.png"}) std::filesystem::remove(folder / gone);
  const Preset opened = openTarget(file.string());
  EXPECT_EQ(opened.scene, "room");
  EXPECT_EQ(opened.width, 32);
  EXPECT_EQ(opened.file, file);
  EXPECT_EQ(presetHash(opened), presetHash(preset)) << "a bundle is no other experiment";
  for (const Scene& s : {loadScene("room", nullptr, file), loadScene(file.string()), loadScene("room", nullptr, file.parent_path())}) {
    EXPECT_EQ(s.hash, scene.hash);
    EXPECT_EQ(s.name, "room");
    EXPECT_EQ(s.objects, scene.objects);
    EXPECT_EQ(s.textures.at(0).rgba, scene.textures.at(0).rgba);
    EXPECT_EQ(s.materials.at(0).name, "paint");
    EXPECT_EQ(s.spotLights.at(0).name, "spot");
    EXPECT_EQ(s.directionalLights.at(0).irradiance, vec3(1, 2, 3));
    EXPECT_EQ(s.cameras.at(0).name, "front");
    EXPECT_EQ(s.cameras.at(0).position, scene.cameras.at(0).position);
    EXPECT_EQ(s.regions.at(0).name, "corner");
    EXPECT_EQ(s.bounds.max, scene.bounds.max);
    EXPECT_EQ(s.source, file);
  }
}

TEST_F(BundleTest, WhatIsWrongIsSaid) {
  std::filesystem::create_directories(file.parent_path());
  write();
  const std::string whole = readFile(file);
  EXPECT_NE(messageOf([&] { openTarget((folder / "none.hlb").string()); }).find("none.hlb"), std::string::npos);
  test::writeText(file, whole.substr(0, whole.size() / 2));
  EXPECT_NE(messageOf([&] { openTarget(file.string()); }).find("cut off or damaged"), std::string::npos);
  test::writeText(file, "PK, of some other program's making; long enough to look like something");
  EXPECT_NE(messageOf([&] { openTarget(file.string()); }).find("not a bundle of Halflight's"), std::string::npos);
  std::string other = whole;
  other[std::string("halflight bundle\n").size()] = 77;
  test::writeText(file, other);
  EXPECT_NE(messageOf([&] { openTarget(file.string()); }).find("version 77"), std::string::npos);
  // A sound archive whose scene refers to a vertex that is not there.
  Scene wrong = scene;
  wrong.indices[0].x = 1000;
  writeBundle(file, {preset, {{"room", &wrong}}, {}});
  EXPECT_NE(messageOf([&] { loadScene("room", nullptr, file); }).find("its scene room is damaged"), std::string::npos);
  writeBundle(file, {preset, {{"room", &scene}, {"other", &scene}}, {}});
  EXPECT_NE(messageOf([&] { loadScene(file.string()); }).find("2 scenes (other, room)"), std::string::npos);
  EXPECT_EQ(loadScene("other", nullptr, file).hash, scene.hash);
  EXPECT_NE(messageOf([&] { loadScene("third", nullptr, file); }).find("no scene 'third'"), std::string::npos);
  EXPECT_NE(messageOf([&] { sceneJson(loadScene("room", nullptr, file)); }).find("bundle"), std::string::npos);
}

TEST_F(BundleTest, ReferencesGoToTheCacheAndNothingGoesElsewhere) {
  std::filesystem::create_directories(file.parent_path());
  const std::filesystem::path reference = folder / "cache/references/0123456789abcdef0123456789abcdef_4.reference";
  ReferenceState state({3, 2});
  state.now = state.next = {4, 1};
  storeReference("0123456789abcdef0123456789abcdef", state);
  const std::string holds = readFile(reference);
  cached = {reference};
  write();
  std::filesystem::remove(reference);
  openBundle(file);
  EXPECT_EQ(readFile(reference), holds);
  test::writeText(reference, "of this machine's own making");
  openBundle(file);
  EXPECT_EQ(readFile(reference), "of this machine's own making") << "what is there stays";

  ArchiveWriter evil(kBundleKind, 1);
  evil.add("preset", presetJson(preset));
  for (const char* part : {"cache/references/../../escaped", "cache/../escaped", "cache/references/sub/escaped", "cache/references/.escaped", "cache/import/escaped"})
    evil.add(part, "no");
  evil.write(file);
  openBundle(file);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    EXPECT_EQ(entry.path().filename().string().find("escaped"), std::string::npos) << entry.path();
}

}  // namespace
}  // namespace hl
