// The import cache: the same scene as a fresh import, made anew when anything it rests on changed or it is damaged.
#include <gtest/gtest.h>

#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/scene_build.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

class SceneCache : public testing::Test {
 protected:
  SceneCache() {
    test::writeText(mesh, test::kSquareObj);
    test::writeText(folder / "square.mtl", "newmtl paint\nKd 0.5 0.5 0.5\nmap_Kd t.png\nnorm gone.png\n");
    paint(10);
    setLogSink([this](LogLevel level, std::string_view) { warnings += level == LogLevel::Warning; });
  }
  ~SceneCache() override { setLogSink({}); }
  void paint(int value) {
    test::writePng(folder / "t.png", 4, 4, 3, [&](int, int, int) { return value; });
  }
  std::string hash() { return sceneContentHash(importMeshCached(mesh, 1, nullptr)); }
  std::filesystem::path cacheFile() { return importCacheFile(mesh, 1); }
  /// Whether the cache was written since: its content has a mark that a rebuild removes.
  bool rebuiltBy(const std::function<void()>& change) {
    hash();
    change();
    const auto before = std::filesystem::last_write_time(cacheFile());
    std::filesystem::last_write_time(cacheFile(), before - std::chrono::hours(1));
    const auto marked = std::filesystem::last_write_time(cacheFile());
    hash();
    return std::filesystem::last_write_time(cacheFile()) != marked;
  }

  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};
  const std::filesystem::path mesh = folder / "square.obj";
  int warnings = 0;
};

TEST_F(SceneCache, HitGivesTheSameScene) {
  const Scene fresh = importMesh(mesh, 1, nullptr);
  EXPECT_FALSE(std::filesystem::exists(cacheFile()));
  const Scene written = importMeshCached(mesh, 1, nullptr);
  EXPECT_TRUE(std::filesystem::exists(cacheFile()));
  EXPECT_FALSE(rebuiltBy([] {}));
  const Scene hit = importMeshCached(mesh, 1, nullptr);
  for (const Scene* s : {&written, &hit}) {
    EXPECT_EQ(sceneContentHash(*s), sceneContentHash(fresh));
    EXPECT_EQ(s->objects, fresh.objects);
    EXPECT_EQ(s->materials[0].name, "paint");
    EXPECT_EQ(s->textures[0].name, fresh.textures[0].name);
    EXPECT_EQ(s->report.warnings, fresh.report.warnings);
    EXPECT_EQ(s->report.missingTextures, 1u);
    EXPECT_TRUE(s->hasUvs);
  }
  EXPECT_EQ(warnings, 0);
}

TEST_F(SceneCache, ChangesOfWhatItReadAreSeen) {
  const std::string first = hash();
  EXPECT_TRUE(rebuiltBy([&] { paint(200); }));
  EXPECT_NE(hash(), first);
  paint(10);
  EXPECT_EQ(hash(), first);
  EXPECT_TRUE(rebuiltBy(
      [&] { test::writeText(folder / "square.mtl", "newmtl paint\nKd 0.1 0.5 0.5\nmap_Kd t.png\nnorm gone.png\n"); }));
  EXPECT_NE(hash(), first);
  // A file that was missing and came is a change as well.
  EXPECT_TRUE(rebuiltBy([&] { std::filesystem::copy_file(folder / "t.png", folder / "gone.png"); }));
  EXPECT_EQ(importMeshCached(mesh, 1, nullptr).report.missingTextures, 0u);
}

TEST_F(SceneCache, ScaleAndContentHaveTheirOwnEntries) {
  EXPECT_NE(importCacheFile(mesh, 1), importCacheFile(mesh, 0.01));
  const auto before = cacheFile();
  test::writeText(mesh, std::string(test::kSquareObj) + "# changed\n");
  EXPECT_NE(cacheFile(), before);
}

TEST_F(SceneCache, DamageIsFoundAndRepaired) {
  const std::string right = hash();
  const std::string whole = readFile(cacheFile());
  const auto repaired = [&](const std::string& content, int expectedWarnings) {
    warnings = 0;
    test::writeText(cacheFile(), content);
    EXPECT_EQ(hash(), right);
    EXPECT_EQ(readFile(cacheFile()), whole);
    EXPECT_EQ(warnings, expectedWarnings);
  };
  for (const size_t at : {size_t{3}, size_t{40}, whole.size() / 2, whole.size() - 1}) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    repaired(flipped, 1);
  }
  for (const size_t size : {size_t{0}, size_t{10}, size_t{60}, whole.size() - 1}) repaired(whole.substr(0, size), 1);
  repaired(whole + "x", 1);
  repaired("some other program's file, long enough to hold a header of ours and then some more", 1);
  std::string older = whole;
  older[17] = static_cast<char>(older[17] + 1);  // the version: no damage, merely of no use
  repaired(older, 0);
}

TEST_F(SceneCache, FolderThatCannotBeWrittenCostsNothingButTime) {
  test::writeText(folder / "cache/import", "a file where a folder should be");
  EXPECT_EQ(importMeshCached(mesh, 1, nullptr).triangles(), 2u);
  EXPECT_EQ(warnings, 1);
}

}  // namespace
}  // namespace hl
