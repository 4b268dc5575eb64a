// Turned, arched and draped shapes of scene files, and copies of shapes: closed ones have the volume they should, which also tells their sides.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/scene/scene_file.h"
#include "tests/temporary_folder.h"

namespace hl {
namespace {

class Shapes : public ::testing::Test {
 protected:
  Scene of(const std::string& shapes) {
    writeFileAtomically(folder / "shapes.json", R"({"version": 1, "lightmap_uvs": true, "materials": {"m": {"albedo": 0.5}}, "shapes": [)" + shapes + "]}");
    return loadScene((folder / "shapes.json").string());
  }
  /// By the divergence theorem; negative where triangles face inwards.
  static double volume(const Scene& s) {
    double sum = 0;
    for (const uvec3 t : s.indices) sum += static_cast<double>(glm::dot(s.positions[t.x], glm::cross(s.positions[t.y], s.positions[t.z]))) / 6;
    return sum;
  }
  static double area(const Scene& s) {
    double sum = 0;
    for (const uvec3 t : s.indices) sum += 0.5 * static_cast<double>(glm::length(glm::cross(s.positions[t.y] - s.positions[t.x], s.positions[t.z] - s.positions[t.x])));
    return sum;
  }
  /// Vertex normals are unit and on the triangles' fronts.
  static void expectNormals(const Scene& s) {
    for (const uvec3 t : s.indices) {
      const vec3 n = glm::cross(s.positions[t.y] - s.positions[t.x], s.positions[t.z] - s.positions[t.x]);
      for (const uint32_t v : {t.x, t.y, t.z}) {
        ASSERT_NEAR(glm::length(s.normals[v]), 1, 1e-4f);
        ASSERT_GT(glm::dot(s.normals[v], n), 0);
      }
    }
    for (const vec2 uv : s.lightmapUvs) ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
  }
  test::TemporaryFolder folder;
};

TEST_F(Shapes, ALatheTurnsItsProfile) {
  const Scene s = of(R"({"type": "lathe", "material": "m", "centre": [3, 1, 2], "subdivisions": 128, "profile": [[0, 0], [1, 0], [1, 2], [0, 2]]})");
  EXPECT_NEAR(volume(s), 2 * 3.14159265, 5e-3);
  EXPECT_NEAR(area(s), 6 * 3.14159265, 1e-2);
  expectNormals(s);
  EXPECT_NEAR(s.bounds.min.y, 1, 1e-6f);
  EXPECT_NEAR(s.bounds.max.x, 4, 1e-6f);
}

TEST_F(Shapes, AnArchIsAWallWithARoundOpening) {
  for (const char* along : {"x", "z"}) {
    const std::string box = *along == 'x' ? R"("min": [-2, 1, 3], "max": [2, 4, 3.5])" : R"("min": [3, 1, -2], "max": [3.5, 4, 2])";
    const Scene s = of(R"({"type": "arch", "material": "m", "radius": 1.5, "subdivisions": 200, "along": ")" + std::string(along) + "\", " + box + "}");
    EXPECT_NEAR(volume(s), 0.5 * (4 * 3 - 0.5 * 3.14159265 * 1.5 * 1.5), 1e-3) << along;
    expectNormals(s);
    EXPECT_EQ(s.bounds.min, *along == 'x' ? vec3(-2, 1, 3) : vec3(3, 1, -2));
    EXPECT_EQ(s.bounds.max, *along == 'x' ? vec3(2, 4, 3.5f) : vec3(3.5f, 4, 2));
  }
}

TEST_F(Shapes, AClothHangsInFolds) {
  const Scene s = of(R"({"type": "cloth", "material": "m", "corners": [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]], "subdivisions": 40, "folds": 4, "depth": 0.1})");
  EXPECT_EQ(s.triangles(), 3200u);
  EXPECT_GT(area(s), 6.1);
  EXPECT_LT(area(s), 9);
  EXPECT_NEAR(s.bounds.max.z, 0.1, 0.02f);
  expectNormals(s);
}

TEST_F(Shapes, CopiesStandInRows) {
  const Scene s = of(R"({"type": "box", "name": "b", "material": "m", "min": [0, 0, 0], "max": [1, 1, 1], "copies": [{"count": 3, "step": [2, 0, 0]}, {"count": 2, "step": [0, 0, 5]}]})");
  EXPECT_EQ(s.objects, (std::vector<std::string>{"b 1", "b 2", "b 3", "b 4", "b 5", "b 6"}));
  EXPECT_NEAR(volume(s), 6, 1e-5);
  EXPECT_EQ(s.bounds.max, vec3(5, 1, 6));
}

TEST_F(Shapes, BadOnesAreRefused) {
  const auto refused = [&](const std::string& shape, const std::string& word) {
    try {
      of(shape);
      ADD_FAILURE() << shape;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
      EXPECT_EQ(e.exitCode(), 2);
    }
  };
  refused(R"({"type": "lathe", "material": "m", "centre": [0, 0, 0], "profile": [[1, 0]]})", "at least two points");
  refused(R"({"type": "lathe", "material": "m", "centre": [0, 0, 0], "profile": [[1, 0], [1, 0]]})", "profile[1]");
  refused(R"({"type": "arch", "material": "m", "min": [0, 0, 0], "max": [2, 2, 1], "radius": 1})", "radius");
  refused(R"({"type": "cloth", "material": "m", "corners": [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]]})", "subdivisions");
  refused(R"({"type": "quad", "material": "m", "corners": [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]], "copies": [{"count": 500, "step": [1, 0, 0]}, {"count": 500, "step": [0, 1, 0]}]})", "more than 20000");
  refused(R"({"type": "box", "material": "m", "min": [0, 0, 0], "max": [1, 1, 1], "subdivisions": 256, "copies": [{"count": 500, "step": [1, 0, 0]}]})", "triangles");
}

}  // namespace
}  // namespace hl
