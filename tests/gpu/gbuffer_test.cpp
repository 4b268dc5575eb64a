// The G-buffer against a ray caster in double precision that shares nothing with it.
#include "engine/passes/gbuffer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "engine/scene/texture_sampling.h"
#include "tests/gpu_fixture.h"
#include "tests/trace_scenes.h"

namespace hl {
namespace {

using D3 = std::array<double, 3>;
D3 toDouble(vec3 v) { return {v.x, v.y, v.z}; }
D3 minus(const D3& a, const D3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
D3 cross(const D3& a, const D3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const D3& a, const D3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct Found {
  uint32_t triangle = kNone;
  double t = 1e300, u = 0, v = 0;
};

Found cast(const Scene& scene, const D3& origin, const D3& direction) {
  Found best;
  for (uint32_t i = 0; i < scene.indices.size(); ++i) {
    const uvec3 index = scene.indices[i];
    const D3 p0 = toDouble(scene.positions[index.x]);
    const D3 a = minus(toDouble(scene.positions[index.y]), p0), b = minus(toDouble(scene.positions[index.z]), p0);
    const D3 p = cross(direction, b);
    const double det = dot(a, p);
    if (det == 0) continue;
    const D3 s = minus(origin, p0), q = cross(s, a);
    const double u = dot(s, p) / det, v = dot(direction, q) / det, t = dot(b, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || t <= 0 || t >= best.t) continue;
    best = {i, t, u, v};
  }
  return best;
}

class GBufferTest : public test::GpuTest {
 protected:
  static constexpr int kWidth = 96, kHeight = 64;

  void render(const Scene& scene, const Camera& camera, const std::vector<vec2>& corners = {}) {
    gpuScene = uploadScene(*device, scene);
    const Buffer cornerUvs = corners.empty() ? Buffer() : device->buffer("corner uvs", std::span<const vec2>(corners));
    g = recordGBuffer(*graph, gpuScene, cornerUvs, camera, kWidth, kHeight);
    timings = graph->execute();
    position = device->download(g.position), normal = device->download(g.normal),
    geometric = device->download(g.geometricNormal);
    albedo = device->download(g.albedo), emission = device->download(g.emission);
    ids.resize(position.pixels() * 2);
    device->download(g.ids, ids.data(), ids.size() * 4);
  }
  static vec3 rgb(const Image& image, int x, int y) {
    const float* p = image.pixel(x, y);
    return vec3(p[0], p[1], p[2]);
  }
  uint32_t triangleAt(int x, int y) const { return ids[2 * static_cast<size_t>(y * kWidth + x)] - 1; }
  bool seen(int x, int y) const { return position.pixel(x, y)[3] != 0; }
  size_t holes() const {
    size_t n = 0;
    for (size_t i = 0; i < position.pixels(); ++i) n += position.data[4 * i + 3] == 0;
    return n;
  }

  /// Every pixel against the caster. Where another triangle is seen, it must be the nearest a sixty-fourth of a pixel
  /// away (the rasteriser rounds corners); that may be so at few pixels.
  void compare(const Scene& scene, const Camera& camera, size_t mayDiffer) {
    const CameraBasis basis = cameraBasis(camera, static_cast<float>(kWidth) / kHeight);
    const D3 origin = toDouble(basis.origin);
    size_t differ = 0;
    double worst = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto through = [&](double dx, double dy) {
          const double sx = 2 * (x + 0.5 + dx) / kWidth - 1, sy = 2 * (y + 0.5 + dy) / kHeight - 1;
          D3 d;
          for (int k = 0; k < 3; ++k)
            d[static_cast<size_t>(k)] = basis.forward[k] + sx * basis.right[k] + sy * basis.down[k];
          return d;
        };
        const D3 direction = through(0, 0);
        const Found truth = cast(scene, origin, direction);
        if (triangleAt(x, y) != truth.triangle) {
          ++differ;
          bool near = false;
          for (const double dx : {-1.0 / 64, 0.0, 1.0 / 64}) {
            for (const double dy : {-1.0 / 64, 0.0, 1.0 / 64})
              near = near || cast(scene, origin, through(dx, dy)).triangle == triangleAt(x, y);
          }
          EXPECT_TRUE(near) << "pixel " << x << ", " << y << " shows triangle " << triangleAt(x, y) << ", nearest is "
                            << truth.triangle;
          continue;
        }
        if (truth.triangle == kNone) {
          EXPECT_EQ(position.pixel(x, y)[3], 0);
          continue;
        }
        for (int k = 0; k < 3; ++k) {
          const double exact = origin[static_cast<size_t>(k)] + truth.t * direction[static_cast<size_t>(k)];
          worst = std::max(worst, std::abs(exact - position.pixel(x, y)[k]));
        }
        const uint32_t material = scene.materialIds[truth.triangle];
        EXPECT_EQ(ids[2 * static_cast<size_t>(y * kWidth + x) + 1], material);
        // Unit normals, towards the camera.
        EXPECT_NEAR(glm::length(rgb(normal, x, y)), 1, 1e-5f);
        EXPECT_NEAR(glm::length(rgb(geometric, x, y)), 1, 1e-5f);
        const vec3 d(static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                     static_cast<float>(direction[2]));
        EXPECT_LT(glm::dot(rgb(geometric, x, y), d), 0);
      }
    }
    EXPECT_LE(differ, mayDiffer);
    EXPECT_LT(worst, 1e-5 * scene.bounds.diagonal());
    const double share = worst / scene.bounds.diagonal();
    std::printf("%zu pixels on edges, positions within %.1e of the diagonal\n", differ, share);
  }

  GpuScene gpuScene;
  GBuffer g;
  BatchTimings timings;
  Image position, normal, geometric, albedo, emission;
  std::vector<uint32_t> ids;
};

Camera lookingAt(vec3 from, vec3 to, float fov = 1.0f) {
  Camera c;
  c.position = from, c.target = to, c.verticalFov = fov;
  return c;
}

TEST_F(GBufferTest, AgreesWithARayCasterInAFurnishedRoom) {
  for (const float scale : {1.0f, 1e-3f, 1e3f}) {
    const Scene scene = test::furnishedRoom(scale);
    const Camera camera = lookingAt(vec3(0.95f, 0.9f, 0.92f) * scale, vec3(0.3f) * scale, 1.3f);
    render(scene, camera);
    EXPECT_EQ(holes(), 0u) << "a closed room seen from inside";
    compare(scene, camera, 12);
  }
}

/// Where two walls meet a pixel's point stays in front of both, also where the pixel's centre lies on the edge to the bit.
TEST_F(GBufferTest, PointsOnEdgesStayInFrontOfTheNextWall) {
  Scene scene;
  test::addRoom(scene, -1, 1, test::addMaterial(scene));
  constexpr int kColumn = kWidth - 8;  // its centres see the edge between the far wall and the right one
  const float across = 2 * (static_cast<float>(kColumn) + 0.5f) / kWidth - 1, aspect = static_cast<float>(kWidth) / kHeight;
  render(scene, lookingAt(vec3(0), vec3(0, 0, -1), 2 * std::atan(1 / (across * aspect))));
  size_t onEdges = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_TRUE(seen(x, y));
      const vec3 p = rgb(position, x, y);
      std::array<float, 3> gaps{1 - std::abs(p.x), 1 - std::abs(p.y), 1 - std::abs(p.z)};
      std::sort(gaps.begin(), gaps.end());
      EXPECT_NEAR(gaps[0], 0, 1e-6f);
      EXPECT_GT(gaps[1], 1e-6f) << x << ", " << y;
      onEdges += gaps[1] < 1e-5f;
    }
  }
  EXPECT_GT(onEdges, 10u);
}

/// A sphere of n x 2n quads, smooth normals, its front inside.
Scene sphereFromInside(uint32_t n) {
  Scene scene;
  test::addMaterial(scene);
  scene.objects.emplace_back("sphere");
  for (uint32_t i = 0; i <= n; ++i) {
    for (uint32_t j = 0; j <= 2 * n; ++j) {
      const float theta = kPi * static_cast<float>(i) / static_cast<float>(n);
      // The seam's two columns are the same points to the bit.
      const float phi = kPi * static_cast<float>(j % (2 * n)) / static_cast<float>(n);
      const float ring = i == 0 || i == n ? 0 : std::sin(theta);
      const vec3 p(ring * std::cos(phi), std::cos(theta), ring * std::sin(phi));
      scene.positions.push_back(p);
      scene.normals.push_back(-p);
      scene.uvs.emplace_back(0.0f);
      scene.bounds.extend(p);
    }
  }
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < 2 * n; ++j) {
      const uint32_t a = i * (2 * n + 1) + j, b = a + 1, c = a + 2 * n + 1, d = c + 1;
      if (i > 0) scene.indices.emplace_back(a, c, b);
      if (i + 1 < n) scene.indices.emplace_back(b, c, d);
    }
  }
  scene.materialIds.assign(scene.indices.size(), 0);
  scene.objectIds.assign(scene.indices.size(), 0);
  return scene;
}

TEST_F(GBufferTest, HasNoHolesBetweenTriangles) {
  const Scene scene = sphereFromInside(120);  // 57 360 triangles: several a pixel in places
  for (const Camera& camera :
       {lookingAt(vec3(0), vec3(0.3f, 1, 0.2f), 2.0f), lookingAt(vec3(0.9f, 0, 0), vec3(1, 0.05f, 0), 1.5f),
        lookingAt(vec3(-0.5f, 0.5f, 0.5f), vec3(0.4f, -1, 0.3f), 1.0f)}) {
    render(scene, camera);
    EXPECT_EQ(holes(), 0u);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        // The smooth normal points at the centre.
        ASSERT_GT(glm::dot(rgb(normal, x, y), -glm::normalize(rgb(position, x, y))), 0.9999f);
        ASSERT_NEAR(std::abs(position.pixel(x, y)[3]), 1, 0);
      }
    }
  }
}

TEST_F(GBufferTest, GlossySurfacesHaveTheirLobe) {
  Scene scene;
  const uint32_t lobe = test::addMaterial(scene), both = test::addMaterial(scene), grey = test::addMaterial(scene);
  scene.materials[lobe].specular = vec3(0.1f, 0.2f, 0.3f), scene.materials[lobe].roughness = 0.25f;
  scene.materials[both].specular = vec3(0.5f), scene.materials[both].twoSided = true;
  test::addQuad(scene, vec3(-3, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), lobe);
  test::addQuad(scene, vec3(-1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), both);
  test::addQuad(scene, vec3(1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), grey);
  const auto at = [&](int x, int y) {
    const Image image = device->download(g.specular);
    const float* p = image.pixel(x, y);
    return vec4(p[0], p[1], p[2], p[3]);
  };
  const int left = kWidth / 6, middle = kWidth / 2, right = kWidth * 5 / 6, row = kHeight / 2;
  render(scene, lookingAt(vec3(0, 0, 4), vec3(0), 0.9f));
  ASSERT_TRUE(g.specular);
  EXPECT_EQ(at(left, row), vec4(0.1f, 0.2f, 0.3f, 0.25f));
  EXPECT_EQ(at(middle, row), vec4(0.5f, 0.5f, 0.5f, kDefaultRoughness));
  EXPECT_EQ(vec3(at(right, row)), vec3(0));
  EXPECT_EQ(at(0, 0), vec4(0)) << "no surface";
  render(scene, lookingAt(vec3(0, 0, -4), vec3(0), 0.9f));
  EXPECT_EQ(at(right, row), vec4(0)) << "the back of a one-sided surface";
  EXPECT_EQ(vec3(at(middle, row)), vec3(0.5f));

  for (Material& m : scene.materials) m.specular = vec3(0.0f);
  render(scene, lookingAt(vec3(0, 0, 4), vec3(0), 0.9f));
  EXPECT_FALSE(g.specular);
  for (const PassTiming& p : timings.passes)
    if (p.name == "gbuffer: specular") {
      EXPECT_EQ(p.skipped, "scene has no glossy surfaces");
    }
}

TEST_F(GBufferTest, KnowsFrontsFromBacks) {
  Scene scene;
  const uint32_t lamp = test::addMaterial(scene, vec3(5, 100000, 7)), both = test::addMaterial(scene),
                 grey = test::addMaterial(scene);
  scene.materials[both].twoSided = true;
  scene.materials[both].albedo = vec3(0.25f, 0.5f, 0.75f);
  scene.materials[grey].albedo = vec3(2, 0.5f, 0.5f);                         // capped
  test::addQuad(scene, vec3(-3, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), lamp);  // fronts towards +z
  test::addQuad(scene, vec3(-1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), both);
  test::addQuad(scene, vec3(1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), grey);
  const int left = kWidth / 6, middle = kWidth / 2, right = kWidth * 5 / 6, row = kHeight / 2;

  render(scene, lookingAt(vec3(0, 0, 4), vec3(0), 0.9f));
  EXPECT_EQ(rgb(emission, left, row), vec3(5, 100000, 7));
  EXPECT_EQ(position.pixel(left, row)[3], 1);
  EXPECT_EQ(rgb(albedo, middle, row), vec3(0.25f, 0.5f, 0.75f));
  EXPECT_EQ(rgb(albedo, right, row), vec3(kMaxAlbedo, 0.5f, 0.5f));
  EXPECT_NEAR(rgb(normal, middle, row).z, 1, 1e-6f);

  render(scene, lookingAt(vec3(0, 0, -4), vec3(0), 0.9f));  // the lamp is on the right now
  EXPECT_EQ(rgb(emission, right, row), vec3(0)) << "emitters are one-sided";
  EXPECT_EQ(rgb(albedo, right, row), vec3(0));
  EXPECT_EQ(position.pixel(right, row)[3], -1);
  EXPECT_EQ(rgb(albedo, left, row), vec3(0)) << "the back of a one-sided material";
  EXPECT_EQ(rgb(albedo, middle, row), vec3(0.25f, 0.5f, 0.75f));
  EXPECT_EQ(position.pixel(middle, row)[3], -1);
  for (const int x : {left, middle, right}) {
    EXPECT_NEAR(rgb(normal, x, row).z, -1, 1e-6f);
    EXPECT_NEAR(rgb(geometric, x, row).z, -1, 1e-6f);
  }
}

TEST_F(GBufferTest, SeesThroughHolesAndTakesItsColourFromTextures) {
  Scene scene;
  const uint32_t leaf = test::addMaterial(scene), wall = test::addMaterial(scene);
  Texture t;
  t.name = "leaf";
  t.width = 5, t.height = 3;
  for (int i = 0; i < 15; ++i) {
    for (const int v : {17 * i, 255 - 17 * i, 128}) t.rgba.push_back(static_cast<uint8_t>(v));
    t.rgba.push_back(i % 2 == 0 ? 255 : 40);
  }
  scene.textures.push_back(t);
  scene.materials[leaf].albedo = vec3(0.9f, 0.8f, 1.0f);
  scene.materials[leaf].albedoTexture = 0;
  scene.materials[leaf].alphaCutoff = 0.5f;
  test::addQuad(scene, vec3(-2, -1, 0), vec3(4, 0, 0), vec3(0, 2, 0), leaf);
  test::addQuad(scene, vec3(-9, -9, -1), vec3(18, 0, 0), vec3(0, 18, 0), wall);
  scene.hasUvs = true;
  const Camera camera = lookingAt(vec3(0, 0, 2.2f), vec3(0), 1.0f);
  render(scene, camera);
  const CameraBasis basis = cameraBasis(camera, static_cast<float>(kWidth) / kHeight);
  int through = 0, covered = 0, onTheEdge = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const vec3 d = pixelDirection(basis, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, kWidth, kHeight);
      const vec3 p = camera.position - d * (camera.position.z / d.z);  // where z = 0
      const vec2 uv(p.x / 4 + 0.5f, p.y / 2 + 0.5f);
      if (uv.x < 0 || uv.x > 1 || uv.y < 0 || uv.y > 1) continue;
      const float alpha = sampleAlpha(t, uv);
      if (std::abs(alpha - 0.5f) < 1e-3f) {
        ++onTheEdge;
        continue;
      }
      const bool opaque = alpha >= 0.5f;
      ASSERT_EQ(triangleAt(x, y) < 2, opaque) << x << ", " << y << ": alpha " << alpha;
      ++(opaque ? covered : through);
      if (!opaque) continue;
      const vec3 expected = albedoAt(scene, scene.materials[leaf], uv);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(rgb(albedo, x, y)[k], expected[k], 2e-3f) << x << ", " << y;
    }
  }
  EXPECT_GT(through, 500);
  EXPECT_GT(covered, 500);
  EXPECT_LT(onTheEdge, 20);
  EXPECT_EQ(holes(), 0u);
}

TEST_F(GBufferTest, TurnsNormalsByTheirMap) {
  Scene scene;
  const uint32_t bumpy = test::addMaterial(scene);
  Texture t;
  t.name = "bump";
  t.width = t.height = 1;
  t.srgb = false;
  t.rgba = {204, 153, 230, 255};  // (0.6, 0.2, 0.804) before it is made unit
  scene.textures.push_back(t);
  scene.materials[bumpy].normalTexture = 0;
  // u runs along -y and v along x: the tangent frame is turned with them.
  test::addQuad(scene, vec3(-1, 1, 0), vec3(0, -2, 0), vec3(2, 0, 0), bumpy);
  scene.hasUvs = true;
  render(scene, lookingAt(vec3(0.2f, 0.1f, 1), vec3(0), 1.0f));
  const vec3 expected = glm::normalize(vec3(0.2f, -0.6f, 230.0f / 127.5f - 1));
  for (int y = 4; y < kHeight; y += 8) {
    for (int x = kWidth / 3; x < kWidth * 2 / 3; x += 8) {
      ASSERT_TRUE(seen(x, y));
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(rgb(normal, x, y)[k], expected[k], 1e-3f);
      ASSERT_NEAR(rgb(geometric, x, y).z, 1, 1e-6f);
    }
  }
}

TEST_F(GBufferTest, CarriesLightmapCoordinates) {
  Scene scene;
  test::addQuad(scene, vec3(-1, -1, 0), vec3(2, 0, 0), vec3(0, 2, 0), test::addMaterial(scene));
  // u = (x + 1) / 4, v = (y + 1) / 8 + 0.5 over both triangles.
  std::vector<vec2> corners;
  for (const uvec3& i : scene.indices) {
    for (const uint32_t v : {i.x, i.y, i.z})
      corners.emplace_back((scene.positions[v].x + 1) / 4, (scene.positions[v].y + 1) / 8 + 0.5f);
  }
  render(scene, lookingAt(vec3(0.3f, 0.2f, 1.5f), vec3(0.1f, 0, 0), 0.8f), corners);
  size_t n = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (!seen(x, y)) continue;
      ++n;
      ASSERT_NEAR(normal.pixel(x, y)[3], (position.pixel(x, y)[0] + 1) / 4, 1e-5f);
      ASSERT_NEAR(geometric.pixel(x, y)[3], (position.pixel(x, y)[1] + 1) / 8 + 0.5f, 1e-5f);
    }
  }
  EXPECT_GT(n, 1000u);
}

TEST_F(GBufferTest, NothingOrOneTriangleIsASceneToo) {
  Scene scene;
  scene.materials.emplace_back();
  render(scene, Camera());
  EXPECT_EQ(holes(), position.pixels());
  EXPECT_EQ(position.data, std::vector<float>(position.data.size(), 0));
  test::addTriangle(scene, vec3(-1, -1, 0), vec3(1, -1, 0), vec3(0, 1, 0), 0);
  render(scene, lookingAt(vec3(0, 0, 2), vec3(0)));
  EXPECT_EQ(triangleAt(kWidth / 2, kHeight / 2), 0u);
  compare(scene, lookingAt(vec3(0, 0, 2), vec3(0)), 4);
}

TEST_F(GBufferTest, LooksStraightUpAndDown) {
  const Scene scene = test::furnishedRoom();
  const vec3 c(0.5f);
  for (const float dy : {0.2f, -0.2f}) {
    const Camera camera = lookingAt(c + vec3(0.05f, 0, 0), c + vec3(0.05f, dy, 0), 1.2f);
    render(scene, camera);
    EXPECT_EQ(holes(), 0u);
    compare(scene, camera, 12);
  }
}

}  // namespace
}  // namespace hl
