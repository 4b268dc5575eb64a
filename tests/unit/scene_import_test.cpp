// Meshes: what is read of OBJ, MTL and glTF, what is dropped and counted, and what is refused with which words.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "engine/core/files.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/texture_sampling.h"
#include "tests/mesh_files.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

using test::SquareGltf;
using test::writeText;

class SceneImport : public testing::Test {
 protected:
  Scene importText(const std::string& name, const std::string& text) {
    writeText(folder / name, text);
    return importMesh(folder / name, 1, nullptr);
  }
  /// One line, bad input, and every one of `words` in it.
  void expectRefused(const std::function<void()>& f, const std::vector<std::string>& words) {
    try {
      f();
      ADD_FAILURE() << "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.exitCode(), 2) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      for (const std::string& word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " in: " << e.what();
    }
  }
  void expectObjRefused(const std::string& text, std::vector<std::string> words) {
    words.push_back("bad.obj");
    expectRefused([&] { importText("bad.obj", text); }, words);
  }

  test::TemporaryFolder folder;
  test::EnvironmentVariable cache{"HALFLIGHT_CACHE", (folder / "cache").string()};
};

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST_F(SceneImport, ObjKeepsGeometryUvsAndWinding) {
  writeText(folder / "square.mtl", "newmtl paint\nKd 0.2 0.4 0.6\nKe 1 2 3\n");
  const Scene s = importText("square.obj", test::kSquareObj);
  ASSERT_EQ(s.triangles(), 2u);
  EXPECT_EQ(s.positions.size(), 4u);
  EXPECT_TRUE(s.hasUvs);
  EXPECT_TRUE(s.lightmapUvs.empty());
  ASSERT_EQ(s.materials.size(), 1u);
  EXPECT_EQ(s.materials[0].name, "paint");
  EXPECT_EQ(s.materials[0].albedo, vec3(0.2f, 0.4f, 0.6f));
  EXPECT_EQ(s.materials[0].emission, vec3(1, 2, 3));
  EXPECT_FALSE(s.materials[0].twoSided);
  EXPECT_EQ(s.objects, std::vector<std::string>{"square"});
  for (const uvec3 t : s.indices) {
    const vec3 n = glm::cross(s.positions[t.y] - s.positions[t.x], s.positions[t.z] - s.positions[t.x]);
    EXPECT_EQ(n, vec3(0, 0, 1));
  }
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(s.uvs[v], vec2(s.positions[v].x, s.positions[v].y));  // v upwards
    EXPECT_EQ(s.normals[v], vec3(0, 0, 1));
  }
}

TEST_F(SceneImport, ScaleIsMetresAUnit) {
  writeText(folder / "a.obj", kCorners + "f 1 2 3\n");
  const Scene s = importMesh(folder / "a.obj", 0.01, nullptr);
  EXPECT_EQ(s.positions[1], vec3(0.01f, 0, 0));
}

TEST_F(SceneImport, NormalsAreGeneratedFlatWhereThereAreNone) {
  const Scene s = importText("a.obj", kCorners + "v 0 0 1\nf 1 2 3\nf 1 3 4\n");
  ASSERT_EQ(s.triangles(), 2u);
  for (size_t t = 0; t < 2; ++t) {
    const uvec3 i = s.indices[t];
    const vec3 n = glm::normalize(glm::cross(s.positions[i.y] - s.positions[i.x], s.positions[i.z] - s.positions[i.x]));
    for (const uint32_t v : {i.x, i.y, i.z}) EXPECT_NEAR(glm::dot(s.normals[v], n), 1, 1e-6f);
  }
}

TEST_F(SceneImport, ZeroNormalsAreReplacedAndReported) {
  const Scene s = importText("a.obj", kCorners + "vn 0 0 0\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(s.normals[0], vec3(0, 0, 1));
  ASSERT_FALSE(s.report.warnings.empty());
  EXPECT_NE(s.report.warnings[0].find("3 normals"), std::string::npos) << s.report.warnings[0];
}

TEST_F(SceneImport, DegenerateTrianglesAreDroppedAndCounted) {
  const Scene s = importText("a.obj", kCorners + "v 2 0 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n");
  EXPECT_EQ(s.triangles(), 1u);
  EXPECT_EQ(s.report.degenerateTriangles, 2u);
  expectObjRefused(kCorners + "v 2 0 0\nf 1 2 4\n", {"no triangles", "1 without area"});
}

TEST_F(SceneImport, ThinTrianglesStay) {
  const Scene s = importText("a.obj", "v 0 0 0\nv 1 0 0\nv 0 0.0001 0\nf 1 2 3\n");
  EXPECT_EQ(s.triangles(), 1u);
  EXPECT_EQ(s.report.degenerateTriangles, 0u);
}

TEST_F(SceneImport, ContinuedLinesCarriageReturnsAndNegativeIndices) {
  const Scene s = importText("a.obj", "v 0 0 0\r\nv 1 0 \\\r\n0\r\nv 0 1 0\r\nf -3 -2 -1\r\n");
  EXPECT_EQ(s.triangles(), 1u);
}

TEST_F(SceneImport, NormalMapComesFromNormAndMapKn) {
  const auto flat = [](int, int, int c) { return c == 2 ? 255 : 128; };
  test::writePng(folder / "maps/n.png", 4, 4, 3, flat);
  for (const std::string key : {"norm", "map_Kn"}) {
    writeText(folder / "square.mtl", "newmtl paint\n" + key + " -bm 1.0 maps\\n.png\n");
    const Scene s = importText("square.obj", test::kSquareObj);
    ASSERT_NE(s.materials[0].normalTexture, kNone) << key;
    EXPECT_FALSE(s.textures[s.materials[0].normalTexture].srgb);
    EXPECT_EQ(s.materials[0].albedoTexture, kNone);
  }
  writeText(folder / "square.mtl", "newmtl paint\nbump maps/n.png\n");
  const Scene s = importText("square.obj", test::kSquareObj);
  EXPECT_EQ(s.materials[0].normalTexture, kNone);  // a height field is not a normal map
  ASSERT_EQ(s.report.warnings.size(), 1u);
  EXPECT_NE(s.report.warnings[0].find("bump"), std::string::npos);
}

TEST_F(SceneImport, MapDCutsOutAndMakesTwoSided) {
  test::writePng(folder / "leaf.png", 4, 4, 4, [](int x, int, int c) { return c == 3 ? (x < 2 ? 255 : 0) : 100 + c; });
  writeText(folder / "square.mtl", "newmtl paint\nmap_Kd leaf.png\nmap_d leaf.png\n");
  const Scene s = importText("square.obj", test::kSquareObj);
  const Material& m = s.materials[0];
  EXPECT_EQ(m.alphaCutoff, 0.5f);
  EXPECT_TRUE(m.twoSided);
  ASSERT_EQ(s.textures.size(), 1u);
  EXPECT_EQ(s.textures[0].rgba[0], 100);  // colours as stored, not multiplied by alpha
  EXPECT_EQ(s.textures[0].rgba[4 * 3], 100);
  EXPECT_TRUE(opaqueAt(s, m, vec2(0.25f, 0.5f)));
  EXPECT_FALSE(opaqueAt(s, m, vec2(0.75f, 0.5f)));
}

TEST_F(SceneImport, MapDOfAnotherFileIsMergedIntoAlpha) {
  test::writePng(folder / "colour.png", 8, 8, 3, [](int, int, int c) { return 50 * (c + 1); });
  test::writePng(folder / "mask.png", 4, 4, 1, [](int, int y, int) { return y < 2 ? 255 : 0; });
  writeText(folder / "square.mtl", "newmtl paint\nmap_Kd colour.png\nmap_d mask.png\n");
  const Scene s = importText("square.obj", test::kSquareObj);
  ASSERT_EQ(s.textures.size(), 1u);
  EXPECT_EQ(s.textures[0].width, 8);
  EXPECT_TRUE(opaqueAt(s, s.materials[0], vec2(0.5f, 0.75f)));  // row 0 is at v = 1
  EXPECT_FALSE(opaqueAt(s, s.materials[0], vec2(0.5f, 0.25f)));
}

TEST_F(SceneImport, MissingTextureIsAWarningAndItsConstant) {
  writeText(folder / "square.mtl", "newmtl paint\nKd 0.3 0.3 0.3\nmap_Kd nowhere.png\n");
  const Scene s = importText("square.obj", test::kSquareObj);
  EXPECT_EQ(s.report.missingTextures, 1u);
  EXPECT_EQ(s.materials[0].albedoTexture, kNone);
  EXPECT_EQ(s.materials[0].albedo, vec3(0.3f));
  ASSERT_EQ(s.report.warnings.size(), 1u);
  EXPECT_NE(s.report.warnings[0].find("nowhere.png"), std::string::npos);
}

TEST_F(SceneImport, MissingMaterialsAreWarnings) {
  const Scene s = importText("square.obj", test::kSquareObj);  // no square.mtl
  EXPECT_EQ(s.report.warnings.size(), 2u);
  writeText(folder / "square.mtl", "newmtl other\n");
  const Scene t = importText("square.obj", test::kSquareObj);
  ASSERT_EQ(t.report.warnings.size(), 1u);
  EXPECT_NE(t.report.warnings[0].find("'paint'"), std::string::npos);
}

TEST_F(SceneImport, TextureThatIsNoImageIsRefused) {
  writeText(folder / "square.mtl", "newmtl paint\nmap_Kd square.obj\n");
  expectRefused([&] { importText("square.obj", test::kSquareObj); }, {"square.obj"});
  test::writePng(folder / "whole.png", 64, 64, 3, [](int x, int y, int c) { return (x * 7 + y * 13 + c * 31) % 256; });
  writeText(folder / "cut.png", readFile(folder / "whole.png").substr(0, 400));
  writeText(folder / "square.mtl", "newmtl paint\nmap_Kd cut.png\n");
  expectRefused([&] { importText("square.obj", test::kSquareObj); }, {"cut.png"});
}

TEST_F(SceneImport, LargeTexturesAreReducedToTheCap) {
  test::writePng(folder / "wide.png", 2048, 512, 3, [](int x, int, int) { return x < 1024 ? 0 : 255; });
  writeText(folder / "square.mtl", "newmtl paint\nmap_Kd wide.png\n");
  const Scene s = importText("square.obj", test::kSquareObj);
  ASSERT_EQ(s.textures.size(), 1u);
  EXPECT_EQ(s.textures[0].width, 1024);
  EXPECT_EQ(s.textures[0].height, 256);
  EXPECT_EQ(s.textures[0].rgba[4 * 511], 0);
  EXPECT_EQ(s.textures[0].rgba[4 * 512], 255);
}

TEST_F(SceneImport, BadObjIsRefusedWithFileAndLine) {
  expectObjRefused("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", {":2:", "'nan'", "finite"});
  expectObjRefused("v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n", {":2:", "'inf'"});
  expectObjRefused("v 0 0 0\nv 1 1e99 0\nv 0 1 0\nf 1 2 3\n", {":2:", "'1e99'"});
  expectObjRefused("v 0 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {":1:", "infinity"});
  expectObjRefused("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", {":2:", "3 numbers"});
  expectObjRefused("v 0 0 0\nv 1 0 abc\nv 0 1 0\nf 1 2 3\n", {":2:", "'abc'"});
  expectObjRefused(kCorners + "f 1 2 4\n", {":4:", "vertex 4", "3"});
  expectObjRefused(kCorners + "f 1 2 0\n", {":4:", "index 0"});
  expectObjRefused(kCorners + "f 1 2 -4\n", {":4:", "index -4"});
  expectObjRefused(kCorners + "f 1/1 2/1 3/1\n", {":4:", "texture coordinate 1"});
  expectObjRefused(kCorners + "vn 0 0 1\nf 1//1 2//1 3//2\n", {":5:", "normal 2"});
  expectObjRefused(kCorners + "f 1 2\n", {":4:", "3 corners"});
  expectObjRefused(kCorners + "f 1 2 3/\n", {":4:", "'3/'"});
  expectObjRefused(kCorners + "f 1 2 x\n", {":4:", "'x'"});
  expectObjRefused(kCorners + "f 1 2 99999999999\n", {":4:"});
  expectObjRefused(kCorners, {"no triangles", "3 vertices"});
  expectObjRefused("", {"no triangles"});
}

TEST_F(SceneImport, ObjCutOffInALineIsRefused) {
  const std::string whole = kCorners + "v 0 0 1\nf 1 2 3\nf 1 3 4\n";
  expectObjRefused(whole.substr(0, whole.size() - 3), {":6:", "3 corners"});  // "f 1 3"
  expectObjRefused(whole.substr(0, 21), {":3:", "3 numbers"});                // "v 0 1"
  expectObjRefused(whole.substr(0, 16), {"no triangles"});
}

TEST_F(SceneImport, BadMtlIsRefusedWithFileAndLine) {
  const auto refused = [&](const std::string& mtl, std::vector<std::string> words) {
    writeText(folder / "square.mtl", mtl);
    words.push_back("square.mtl");
    expectRefused([&] { importText("square.obj", test::kSquareObj); }, words);
  };
  refused("newmtl paint\nKd 0.1 nan 0.2\n", {":2:", "Kd"});
  refused("newmtl paint\nKd 0.1 0.2\n", {":2:", "3 numbers"});
  refused("newmtl paint\nKe -1 0 0\n", {":2:", "Ke"});
  refused("newmtl paint\nmap_Kd\n", {":2:", "map_Kd"});
  refused("newmtl\n", {":1:", "name"});
}

TEST_F(SceneImport, UnknownKindAndMissingFile) {
  expectRefused([&] { importText("a.stl", "solid\n"); }, {"a.stl", ".obj, .gltf, .glb"});
  expectRefused([&] { importMesh(folder / "none.obj", 1, nullptr); }, {"none.obj"});
}

TEST_F(SceneImport, GltfAndGlbGiveTheSquare) {
  for (const bool binary : {false, true}) {
    SquareGltf g;
    g.material = R"({"name": "paint", "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}, "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.75, 1]}})";
    g.node = R"({"name": "square", "mesh": 0, "translation": [1, 2, 3], "scale": [2, 2, -2]})";
    const Scene s = importText(binary ? "a.glb" : "a.gltf", binary ? g.binary() : g.embedded());
    ASSERT_EQ(s.triangles(), 2u);
    ASSERT_EQ(s.positions.size(), 4u);
    EXPECT_EQ(s.materials[0].albedo, vec3(0.5f, 0.25f, 0.75f));
    EXPECT_EQ(s.materials[0].emission, vec3(8, 4, 0));
    EXPECT_TRUE(s.materials[0].twoSided);
    EXPECT_EQ(s.objects[0], "square");
    for (size_t v = 0; v < 4; ++v) {
      const vec2 uv = s.uvs[v];
      EXPECT_EQ(s.positions[v], vec3(1 + 2 * uv.x, 2 + 2 * uv.y, 3));  // v upwards once read
      EXPECT_EQ(s.normals[v], vec3(0, 0, -1));                         // the mirror turns the surface
    }
    for (const uvec3 t : s.indices)
      EXPECT_LT(glm::cross(s.positions[t.y] - s.positions[t.x], s.positions[t.z] - s.positions[t.x]).z, 0);
  }
}

TEST_F(SceneImport, GltfTexturesFromFilesUrisAndChunks) {
  test::writePng(folder / "t.png", 4, 4, 4,
                 [](int x, int, int c) { return c == 3 ? (x < 2 ? 255 : 0) : 60 * (c + 1); });
  SquareGltf g;
  g.material = R"({"name": "paint", "alphaMode": "MASK", "alphaCutoff": 0.25, "normalTexture": {"index": 0},
                   "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})";
  const std::string png = readFile(folder / "t.png");
  for (const std::string& image :
       {std::string(R"({"uri": "t.png"})"),
        R"({"mimeType": "image/png", "uri": "data:image/png;base64,)" + test::base64(png) + "\"}"}) {
    g.more = R"(, "textures": [{"source": 0}], "images": [)" + image + "]";
    const Scene s = importText("a.gltf", g.embedded());
    const Material& m = s.materials[0];
    ASSERT_NE(m.albedoTexture, kNone) << image;
    ASSERT_NE(m.normalTexture, kNone);
    EXPECT_EQ(m.alphaCutoff, 0.25f);
    EXPECT_TRUE(s.textures[m.albedoTexture].srgb);
    EXPECT_FALSE(s.textures[m.normalTexture].srgb);
    EXPECT_EQ(s.textures[m.albedoTexture].rgba[1], 120);
    EXPECT_FALSE(opaqueAt(s, m, vec2(0.75f, 0.5f)));
  }
  g.more = R"(, "textures": [{"source": 0}], "images": [{"uri": "data:image/png;base64,aGVsbG8="}])";
  expectRefused([&] { importText("b.gltf", g.embedded()); }, {"b.gltf", "embedded image 0"});
}

TEST_F(SceneImport, BadGltfIsRefusedWithFileAndPlace) {
  const auto refused = [&](const SquareGltf& g, std::vector<std::string> words) {
    words.push_back("bad.gltf");
    expectRefused([&] { importText("bad.gltf", g.embedded()); }, words);
  };
  SquareGltf g;
  g.positions[4] = std::nanf("");
  refused(g, {"meshes[0].primitives[0].attributes.POSITION", "element 1", "not finite"});
  g = {};
  g.indices[5] = 4;
  refused(g, {"meshes[0].primitives[0].indices", "index 5 is 4", "4 vertices"});
  g = {};
  g.node = R"({"mesh": 1})";
  refused(g, {"nodes[0].mesh", "1"});
  g.node = R"({"mesh": 0, "children": [0]})";
  refused(g, {"nodes", "ancestors"});
  g.node = R"({"mesh": "square"})";
  refused(g, {"nodes[0].mesh", "whole number"});
  g = {};
  g.material = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})";
  refused(g, {"materials[0].pbrMetallicRoughness.baseColorTexture.index"});
  g.material = R"({"doubleSided": "yes"})";
  refused(g, {"materials[0].doubleSided", "true or false"});
  g = {};
  g.more = R"(, "extensionsRequired": ["KHR_draco_mesh_compression"])";
  refused(g, {"KHR_draco_mesh_compression"});

  const std::string whole = SquareGltf{}.embedded();
  expectRefused([&] { importText("cut.gltf", whole.substr(0, whole.size() / 2)); }, {"cut.gltf", "not JSON", "line"});
  const std::string binary = SquareGltf{}.binary();
  for (const size_t size : {size_t{6}, size_t{19}, size_t{100}, binary.size() - 1})
    expectRefused([&] { importText("cut.glb", binary.substr(0, size)); }, {"cut.glb", "cut off"});
  expectRefused([&] { importText("text.glb", "hello"); }, {"text.glb", "not a glb"});
  expectRefused([&] { importText("external.gltf", SquareGltf{}.json(R"({"byteLength": 140, "uri": "gone.bin"})")); },
                {"external.gltf", "buffers[0]", "'gone.bin' is missing"});
  writeText(folder / "short.bin", "1234");
  expectRefused([&] { importText("external.gltf", SquareGltf{}.json(R"({"byteLength": 140, "uri": "short.bin"})")); },
                {"external.gltf", "cut off", "140", "4"});
  writeText(folder / "whole.bin", SquareGltf{}.bytes());
  EXPECT_EQ(importText("external.gltf", SquareGltf{}.json(R"({"byteLength": 140, "uri": "whole.bin"})")).triangles(),
            2u);
}

TEST_F(SceneImport, CancelStopsIt) {
  writeText(folder / "a.obj", kCorners + "f 1 2 3\n");
  Progress progress;
  progress.cancel();
  try {
    importMesh(folder / "a.obj", 1, &progress);
    FAIL() << "not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::Cancelled);
  }
}

}  // namespace
}  // namespace hl
