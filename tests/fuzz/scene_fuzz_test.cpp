// Damaged scene, mesh and material files: each is either read or refused as bad input in one line, never anything else.
// Mutations are a function of the seed alone; the time limit only decides how many of them run.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>

#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/scene/animation.h"
#include "engine/scene/gltf_check.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/mtl_file.h"
#include "engine/scene/obj_check.h"
#include "engine/scene/scene_description.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_pose.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

constexpr int kMutations = 2000;          // a format
constexpr double kSecondsPerFormat = 12;  // sanitizers on a slow machine

class Mutator {
 public:
  /// `gentle`: mostly changes of numbers, so that more than the syntax is reached.
  Mutator(std::vector<std::string> words, bool gentle) : words_(std::move(words)), gentle_(gentle) {}

  std::string mutate(std::string text, uint32_t seed) {
    random_.seed(seed);
    for (int n = 1 + below(3); n > 0; --n) once(text);
    return text;
  }

 private:
  int below(size_t n) { return static_cast<int>(random_() % n); }
  size_t place(const std::string& s) { return random_() % (s.size() + 1); }

  void once(std::string& s) {
    const size_t at = place(s), length = std::min<size_t>(static_cast<size_t>(1 + below(12)), s.size() - at);
    if (gentle_ && below(4) != 0) return number(s, at);
    switch (below(7)) {
      case 0:
        s.resize(at);
        break;
      case 1:
        s.erase(at, length);
        break;
      case 2:
        s.insert(at, s.substr(place(s) % (s.size() + 1), static_cast<size_t>(1 + below(40))));
        break;
      case 3:
        if (at < s.size()) s[at] = static_cast<char>(random_());
        break;
      case 4:
        s.insert(at, words_[random_() % words_.size()]);
        break;
      case 5:
        s.replace(at, length, words_[random_() % words_.size()]);
        break;
      default:
        number(s, at);
        break;
    }
  }
  /// Replaces the next number by an awkward one.
  void number(std::string& s, size_t at) {
    static const char* awkward[] = {"0",   "-1",    "1e38",       "-1e39", "4294967296", "18446744073709551615",
                                    "nan", "1e-45", "2147483648", "65536", "0.5",        "-0"};
    const size_t begin = s.find_first_of("0123456789", at);
    if (begin == std::string::npos) return;
    const size_t end = std::min(s.find_first_not_of("0123456789.e", begin), s.size());
    s.replace(begin, end - begin, awkward[random_() % std::size(awkward)]);
  }

  std::mt19937 random_;
  std::vector<std::string> words_;
  bool gentle_;
};

class SceneFuzz : public testing::Test {
 protected:
  SceneFuzz() { setLogLevel(LogLevel::Error); }

  /// Runs `read` on mutations of `text`; gives how many were read and how many refused.
  template <class F>
  void run(const std::string& text, const std::vector<std::string>& words, bool gentle, F&& read) {
    Mutator mutator(words, gentle);
    int accepted = 0, refused = 0;
    const auto start = std::chrono::steady_clock::now();
    for (uint32_t seed = 1; seed <= kMutations; ++seed) {
      if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > kSecondsPerFormat) break;
      const std::string mutated = mutator.mutate(text, seed);
      SCOPED_TRACE(seed);
      try {
        read(mutated);
        ++accepted;
      } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::BadInput) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        ++refused;
      } catch (const std::exception& e) {
        ADD_FAILURE() << "another exception: " << e.what();
      }
      if (HasFailure()) {
        test::writeText(std::filesystem::temp_directory_path() / "halflight-fuzz-failure", mutated);
        FAIL() << "the input is in halflight-fuzz-failure in the temporary folder";
      }
    }
    std::printf("%d read, %d refused\n", accepted, refused);
    // Both sides are reached, however few mutations the time allowed.
    const int ran = accepted + refused;
    EXPECT_GE(ran, 30);
    EXPECT_GT(100 * accepted, ran);
    EXPECT_GT(10 * refused, ran);
  }
  static void expectSound(const Scene& s) {
    EXPECT_FALSE(s.indices.empty());
    for (const vec3 p : s.positions) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    for (const uvec3 i : s.indices) EXPECT_LT(std::max({i.x, i.y, i.z}), s.positions.size());
    for (const uint32_t m : s.materialIds) EXPECT_LT(m, s.materials.size());
  }

  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};
};

TEST_F(SceneFuzz, Obj) {
  test::writeText(folder / "square.mtl", "newmtl paint\nKd 0.5 0.5 0.5\n");
  const std::string text =
      std::string(test::kSquareObj) + "g other\ns 1\nv 0 0 1 0.5 0.5 0.5\nf -1 1 2\nf 1//1 2//1 5//1\nl 1 2\n# end\n";
  run(text,
      {"f ", "v ", "vt ", "vn ", "\n", " ", "/", "//", "-", "\\\n", "usemtl ", "mtllib ", "o ", "g", "nan", "1e40",
       "f 1 1 1\n", "v 0 0\n"},
      false, [&](const std::string& s) {
        test::writeText(folder / "a.obj", s);
        expectSound(importMesh(folder / "a.obj", 1, nullptr));
      });
}

TEST_F(SceneFuzz, Mtl) {
  test::writePng(folder / "t.png", 2, 2, 4, [](int x, int y, int c) { return 50 * (x + y + c); });
  test::writeText(folder / "square.obj", test::kSquareObj);
  run("newmtl paint\nKd 0.5 0.25 0.125\nKe 1 2 3\nmap_Kd -s 1 1 1 t.png\nnorm t.png\nmap_d t.png\nillum 2\n",
      {"newmtl ", "Kd ", "Ke ", "map_Kd ", "map_d ", "norm ", "-o ", "-bm 1 ", "\n", "t.png", "square.obj", "nan",
       "../", "\\"},
      false, [&](const std::string& s) {
        test::writeText(folder / "square.mtl", s);
        expectSound(importMesh(folder / "square.obj", 1, nullptr));
      });
}

const std::vector<std::string> kJsonWords = {"{",    "}",       "[",       "]",    ",",     ":",
                                             "\"",   "null",    "true",    "-1",   "1e400", "\"mesh\"",
                                             "[[[[", "{\"a\":", "\\u0000", "\xff", "0",     "3.5"};

TEST_F(SceneFuzz, SceneJson) {
  test::writeText(folder / "square.obj", test::kSquareObj);
  test::writeText(folder / "square.mtl", "newmtl paint\n");
  run(R"({"version": 1, "mesh": {"file": "square.obj", "import_scale": 0.5}, "shapes": [{"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "material": "wall",
 "subdivisions": 2}, {"type": "icosphere", "centre": [0, 0, 0], "subdivisions": 2, "material": "wall"}],
 "materials": {"paint": {"emission": 1}, "wall": {"albedo": 0.5}}, "lights": [{"type": "point", "position": [0, 1, 0], "intensity": 3}],
 "sky": 0.5, "cameras": [{"name": "a", "position": [0, 0, 1], "target": [0, 0, 0]}], "regions": [{"name": "r", "width": 0.5}]})",
      kJsonWords, true, [&](const std::string& s) {
        test::writeText(folder / "room.json", s);
        const Scene scene = loadScene((folder / "room.json").string());
        EXPECT_FALSE(scene.cameras.empty());
        EXPECT_LE(scene.triangles(), 20000000u);
      });
}

/// What reads is animated as it says: any moment has a pose.
TEST_F(SceneFuzz, AnimationsAndPaths) {
  run(R"({"version": 1, "shapes": [{"type": "box", "name": "b", "min": [0, 0, 0], "max": [1, 1, 1], "material": "wall"}],
 "materials": {"wall": {"albedo": 0.5}}, "lights": [{"type": "point", "name": "lamp", "position": [0, 1, 0], "intensity": 3}],
 "cameras": [{"name": "a", "position": [0, 0, 1], "target": [0, 0, 0]}],
 "animations": [{"name": "turn", "objects": ["b"], "repeat": "ping_pong", "eased": true, "pivot": [0, 1, 0], "axis": [0, 1, 0],
   "keys": [{"time": 0}, {"time": 1.5, "angle_degrees": 90, "translation": [1, 0, 0], "scale": 2}]},
   {"light": "lamp", "repeat": "loop", "keys": [{"time": 0, "intensity_factor": 1, "position": [0, 1, 0]}, {"time": 2, "intensity_factor": 2, "position": [1, 1, 0]}]}],
 "camera_paths": [{"name": "walk", "keys": [{"time": 0, "position": [0, 0, 1], "target": [0, 0, 0]}, {"time": 2, "position": [1, 0, 1], "target": [0, 0, 0], "vertical_fov_degrees": 50}]}]})",
      kJsonWords, true, [&](const std::string& s) {
        test::writeText(folder / "moves.json", s);
        Scene scene = loadScene((folder / "moves.json").string());
        ScenePose pose(scene);
        for (const double time : {0.0, 0.7, 31.0}) {
          pose.apply(scene, time);
          for (const vec3& p : scene.positions) EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) << s;
          for (const CameraPath& path : scene.cameraPaths) EXPECT_TRUE(std::isfinite(cameraAt(path, time).position.x)) << s;
        }
      });
}

TEST_F(SceneFuzz, Gltf) {
  test::SquareGltf g;
  test::writePng(folder / "t.png", 2, 2, 4, [](int x, int y, int c) { return 50 * (x + y + c); });
  g.material =
      R"({"name": "paint", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.5, "emissiveFactor": [1, 1, 1], "normalTexture": {"index": 0},
    "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0}}})";
  g.more = R"(, "textures": [{"source": 0}], "images": [{"uri": "t.png"}])";
  g.node = R"({"name": "a", "mesh": 0, "children": []})";
  run(g.embedded(), kJsonWords, true, [&](const std::string& s) {
    test::writeText(folder / "a.gltf", s);
    expectSound(importMesh(folder / "a.gltf", 1, nullptr));
  });
}

TEST_F(SceneFuzz, Glb) {
  const std::string whole = test::SquareGltf{}.binary();
  run(whole, {std::string("\0\0\0\0", 4), "\xff\xff\xff\x7f", "glTF", "JSON", "{}", " "}, true,
      [&](const std::string& s) {
        test::writeText(folder / "a.glb", s);
        expectSound(importMesh(folder / "a.glb", 1, nullptr));
      });
}

}  // namespace
}  // namespace hl
