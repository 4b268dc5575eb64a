// The lightmap atlas: exact areas, coverage, overlaps, margins, centroids, and texels inside other geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/lightmap/atlas.h"
#include "engine/lightmap/inside.h"
#include "engine/lightmap/pack.h"
#include "engine/lightmap/raster.h"

namespace hl {
namespace {

struct Maker {
  Scene scene;
  Maker() { scene.materials.push_back({}); }

  uint32_t vertex(vec3 p, vec2 uv = vec2(0.0f)) {
    scene.positions.push_back(p);
    scene.uvs.push_back(uv);
    return static_cast<uint32_t>(scene.positions.size() - 1);
  }
  void triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t material = 0) {
    scene.indices.push_back({a, b, c});
    scene.materialIds.push_back(material);
    scene.objectIds.push_back(0);
  }
  /// Corner, two sides; seen from cross(u, v). UVs fill the rectangle from `low` to `high`.
  void quad(vec3 corner, vec3 u, vec3 v, vec2 low = vec2(0.0f), vec2 high = vec2(0.0f), uint32_t material = 0) {
    const uint32_t a = vertex(corner, low), b = vertex(corner + u, vec2(high.x, low.y)), c = vertex(corner + u + v, high),
                   d = vertex(corner + v, vec2(low.x, high.y));
    triangle(a, b, c, material);
    triangle(a, c, d, material);
  }
  /// Six sides, seen from outside (or, `inwards`, from inside).
  void box(vec3 low, vec3 size, bool inwards = false) {
    for (int axis = 0; axis < 3; ++axis) {
      vec3 u(0.0f), v(0.0f), w(0.0f);
      u[(axis + 1) % 3] = size[(axis + 1) % 3];
      v[(axis + 2) % 3] = size[(axis + 2) % 3];
      w[axis] = size[axis];
      inwards ? quad(low + w, v, u) : quad(low + w, u, v);
      inwards ? quad(low, u, v) : quad(low, v, u);
    }
  }
  /// Latitude and longitude; triangles at the poles are single.
  void sphere(vec3 centre, float radius, int rings, int segments) {
    const auto at = [&](int r, int s) {
      const double theta = static_cast<double>(kPi) * r / rings, phi = 2 * static_cast<double>(kPi) * (s % segments) / segments;
      return centre + radius * vec3(glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)));
    };
    for (int r = 0; r < rings; ++r) {
      for (int s = 0; s < segments; ++s) {
        const uint32_t a = vertex(at(r, s)), b = vertex(at(r + 1, s)), c = vertex(at(r + 1, s + 1)), d = vertex(at(r, s + 1));
        if (r + 1 < rings) triangle(a, c, b);
        if (r > 0) triangle(a, d, c);
      }
    }
  }
};

double areaOfLumels(const Atlas& atlas) {
  double sum = 0;
  for (const Lumel& l : atlas.lumels) sum += static_cast<double>(l.area);
  return sum;
}

Atlas build(const Scene& scene, int resolution, unsigned threads = 2, int margin = 2) {
  TaskPool pool(threads);
  Progress progress;
  AtlasSettings settings;
  settings.resolution = resolution;
  settings.margin = margin;
  return buildAtlas(scene, settings, pool, progress);
}

bool holds(const Scene& scene, uint32_t t, vec3 point, float slack) {
  const uvec3 i = scene.indices[t];
  const glm::dvec3 a(scene.positions[i.x]), b(scene.positions[i.y]), c(scene.positions[i.z]), p(point);
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double area2 = glm::length(n);
  const double wa = glm::dot(glm::cross(b - p, c - p), n), wb = glm::dot(glm::cross(c - p, a - p), n), wc = glm::dot(glm::cross(a - p, b - p), n);
  const double least = -static_cast<double>(slack) * area2 * area2;
  const double off = std::abs(glm::dot(p - a, n)) / area2;
  return wa >= least && wb >= least && wc >= least && off <= static_cast<double>(slack) * std::sqrt(area2);
}

void expectSound(const Scene& scene, const Atlas& atlas) {
  uint32_t last = 0;
  for (size_t i = 0; i < atlas.lumels.size(); ++i) {
    const Lumel& l = atlas.lumels[i];
    ASSERT_TRUE(i == 0 || l.texel > last);
    last = l.texel;
    ASSERT_EQ(atlas.lumelOfTexel[l.texel], i);
    ASSERT_GT(l.area, 0);
    ASSERT_NEAR(glm::length(l.normal), 1, 1e-5);
    ASSERT_TRUE(holds(scene, l.triangle, l.position, 1e-5f)) << "texel " << l.texel << ", triangle " << l.triangle;
  }
  EXPECT_EQ(atlas.report.validTexels, atlas.lumels.size());
}

TEST(Atlas, UnitQuadWithItsOwnUvsHasExactAreasAndCentroids) {
  Maker m;
  m.scene.hasUvs = true;
  m.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f), vec2(1.0f));
  const Atlas atlas = build(m.scene, 32);
  EXPECT_FALSE(atlas.report.ownCharts);
  EXPECT_EQ(atlas.report.charts, 1u);
  ASSERT_EQ(atlas.lumels.size(), 32u * 32u);
  EXPECT_EQ(atlas.report.overlappingTexels, 0u);
  EXPECT_EQ(atlas.report.coverage, 1.0);
  EXPECT_NEAR(atlas.report.densityMean, 32, 1e-4);
  EXPECT_NEAR(atlas.report.densitySpread, 0, 1e-5);
  for (const Lumel& l : atlas.lumels) {
    ASSERT_NEAR(l.area, 1.0 / 1024, 1e-9);
    ASSERT_NEAR(l.position.x, (static_cast<float>(l.texel % 32) + 0.5f) / 32, 1e-6);
    ASSERT_NEAR(l.position.y, (static_cast<float>(l.texel / 32) + 0.5f) / 32, 1e-6);
    ASSERT_EQ(l.normal, vec3(0, 0, 1));
  }
  expectSound(m.scene, atlas);
}

TEST(Atlas, PartlyCoveredTexelsHaveTheirExactShare) {
  // A triangle from (0, 0) to (1, 0) to (0, 1) on 4 x 4 texels: whole texels below the diagonal, half ones on it.
  Maker m;
  m.scene.hasUvs = true;
  m.triangle(m.vertex(vec3(0), vec2(0, 0)), m.vertex(vec3(1, 0, 0), vec2(1, 0)), m.vertex(vec3(0, 1, 0), vec2(0, 1)));
  const Atlas atlas = build(m.scene, 4);
  ASSERT_FALSE(atlas.report.ownCharts);
  ASSERT_EQ(atlas.lumels.size(), 10u);
  for (const Lumel& l : atlas.lumels) {
    const uint32_t x = l.texel % 4, y = l.texel / 4;
    const bool half = x + y == 3;
    EXPECT_NEAR(l.area, half ? 1.0 / 32 : 1.0 / 16, 1e-8);
    const float centroid = half ? 1.0f / 3 : 0.5f;
    EXPECT_NEAR(l.position.x, (static_cast<float>(x) + centroid) / 4, 1e-6);
    EXPECT_NEAR(l.position.y, (static_cast<float>(y) + centroid) / 4, 1e-6);
  }
}

TEST(Atlas, CubeGetsSixChartsApartWithExactArea) {
  Maker m;
  m.box(vec3(-1), vec3(2));
  for (const int resolution : {8, 32, 64, 100, 256}) {
    const Atlas atlas = build(m.scene, resolution);
    EXPECT_TRUE(atlas.report.ownCharts);
    EXPECT_EQ(atlas.report.charts, 6u);
    EXPECT_EQ(atlas.report.overlappingTexels, 0u);
    EXPECT_EQ(atlas.report.droppedCharts, 0u);
    EXPECT_NEAR(atlas.report.area, 24, 1e-9);
    EXPECT_NEAR(areaOfLumels(atlas), 24, 24e-6) << resolution;
    EXPECT_GT(atlas.report.coverage, resolution >= 64 ? 0.55 : 0.2) << resolution;
    expectSound(m.scene, atlas);
    // No texel of one chart within the margin of another's.
    for (int y = 0; y < resolution; ++y) {
      for (int x = 0; x < resolution; ++x) {
        const uint32_t lumel = atlas.lumelOfTexel[static_cast<size_t>(y * resolution + x)];
        if (lumel == kNone) continue;
        for (int dy = -atlas.report.margin; dy <= atlas.report.margin; ++dy) {
          for (int dx = -atlas.report.margin; dx <= atlas.report.margin; ++dx) {
            const int u = x + dx, v = y + dy;
            if (u < 0 || v < 0 || u >= resolution || v >= resolution) continue;
            const uint32_t other = atlas.lumelOfTexel[static_cast<size_t>(v * resolution + u)];
            if (other == kNone) continue;
            ASSERT_EQ(atlas.charts[atlas.lumels[lumel].triangle], atlas.charts[atlas.lumels[other].triangle]);
          }
        }
      }
    }
    EXPECT_TRUE(resolution < 32 || atlas.report.margin == 2) << resolution << ' ' << atlas.report.margin;
  }
}

TEST(Atlas, AxisAlignedQuadsFillWholeTexels) {
  Maker m;
  m.box(vec3(0), vec3(3, 2, 5));
  const Atlas atlas = build(m.scene, 128);
  for (const Lumel& l : atlas.lumels) {
    const vec3 n = glm::abs(l.normal);
    ASSERT_TRUE(n == vec3(1, 0, 0) || n == vec3(0, 1, 0) || n == vec3(0, 0, 1));
  }
  // Uniform density: the smallest texel is nearly as large as the largest.
  float least = 1e9f, most = 0;
  for (const Lumel& l : atlas.lumels) least = std::min(least, l.area), most = std::max(most, l.area);
  EXPECT_GT(least, 0.9f * most);
}

TEST(Atlas, OverlapsAreCountedAndToleratedOnlyUpToTheTolerance) {
  // Two quads of 16 x 16 texels; the second one's UVs reach into the first by one row.
  Maker m;
  m.scene.hasUvs = true;
  m.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f, 0.0f), vec2(0.5f, 0.5f));
  m.quad(vec3(0, 0, 5), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f, 15.0f / 32), vec2(0.5f, 31.0f / 32));
  TaskPool pool(2);
  Progress progress;
  AtlasSettings settings;
  settings.resolution = 32;
  settings.uvOverlapTolerance = 0.1f;
  const Atlas tolerated = buildAtlas(m.scene, settings, pool, progress);
  EXPECT_FALSE(tolerated.report.ownCharts);
  EXPECT_EQ(tolerated.report.overlappingTexels, 16u);
  EXPECT_EQ(tolerated.report.charts, 2u);
  EXPECT_EQ(std::count(tolerated.texelState.begin(), tolerated.texelState.end(), TexelOverlap), 16);
  settings.uvOverlapTolerance = 0.001f;
  const Atlas own = buildAtlas(m.scene, settings, pool, progress);
  EXPECT_TRUE(own.report.ownCharts);
  EXPECT_EQ(own.report.overlappingTexels, 0u);
  EXPECT_EQ(own.report.charts, 2u);
}

TEST(Atlas, SurfacesThatTouchOnlyInTheLightmapAreTwoCharts) {
  Maker m;
  m.scene.hasUvs = true;
  m.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f, 0.0f), vec2(0.5f, 1.0f));
  m.quad(vec3(9, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.5f, 0.0f), vec2(1.0f, 1.0f));
  const Atlas atlas = build(m.scene, 16);
  EXPECT_FALSE(atlas.report.ownCharts);
  EXPECT_EQ(atlas.report.charts, 2u);
  EXPECT_NE(atlas.charts[1], atlas.charts[2]);
}

TEST(Atlas, CoordinatesThatFoldTrianglesFlatAreNotUsed) {
  Maker m;
  m.scene.hasUvs = true;
  m.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.3f), vec2(0.3f));
  EXPECT_TRUE(build(m.scene, 16).report.ownCharts);
  Maker tiled;
  tiled.scene.hasUvs = true;
  tiled.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f), vec2(3.0f));
  EXPECT_TRUE(build(tiled.scene, 16).report.ownCharts);
}

TEST(Atlas, SecondUvSetComesFirst) {
  Maker m;
  m.scene.hasUvs = true;
  m.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f), vec2(7.0f));
  m.scene.lightmapUvs = {vec2(0.25f, 0.25f), vec2(0.75f, 0.25f), vec2(0.75f, 0.75f), vec2(0.25f, 0.75f)};
  const Atlas atlas = build(m.scene, 16);
  EXPECT_FALSE(atlas.report.ownCharts);
  EXPECT_EQ(atlas.lumels.size(), 64u);
}

TEST(Atlas, SphereKeepsItsAreaAndItsNormals) {
  Maker m;
  m.sphere(vec3(1, 2, 3), 1.5f, 24, 48);
  const Atlas atlas = build(m.scene, 128);
  EXPECT_NEAR(areaOfLumels(atlas), atlas.report.area, 1e-5 * atlas.report.area);
  EXPECT_EQ(atlas.report.overlappingTexels, 0u);
  EXPECT_LT(atlas.report.densitySpread, 0.15);
  expectSound(m.scene, atlas);
  for (const Lumel& l : atlas.lumels) ASSERT_GT(glm::dot(l.normal, glm::normalize(l.position - vec3(1, 2, 3))), 0.98f);
}

TEST(Atlas, SpiralRampDoesNotLieOnItself) {
  // Three turns of a helix: flat, connected, and one above the other.
  Maker m;
  for (int i = 0; i < 96; ++i) {
    const auto corner = [&](int k, float r) {
      const float a = static_cast<float>(k) * 2 * kPi / 32;
      return vec3(r * std::cos(a), static_cast<float>(k) * 0.02f, -r * std::sin(a));
    };
    const uint32_t a = m.vertex(corner(i, 1)), b = m.vertex(corner(i, 2)), c = m.vertex(corner(i + 1, 2)), d = m.vertex(corner(i + 1, 1));
    m.triangle(a, b, c);
    m.triangle(a, c, d);
  }
  const Atlas atlas = build(m.scene, 128);
  EXPECT_GE(atlas.report.charts, 3u);
  EXPECT_EQ(atlas.report.overlappingTexels, 0u);
  EXPECT_NEAR(areaOfLumels(atlas), atlas.report.area, 1e-5 * atlas.report.area);
}

TEST(Atlas, FloorTexelsUnderABoxAreInside) {
  Maker m;
  m.quad(vec3(-2, 0, 2), vec3(4, 0, 0), vec3(0, 0, -4));
  m.box(vec3(-0.43f, 0, -0.53f), vec3(1));  // its foot runs through the middle of texels
  TaskPool pool(2);
  Progress progress;
  AtlasSettings settings;
  settings.resolution = 64;
  // Brute force over the few triangles: closest hit by Moeller and Trumbore.
  const CastClosest cast = [&](std::span<const shared::Ray> rays, std::span<shared::Hit> hits) {
    for (size_t i = 0; i < rays.size(); ++i) {
      hits[i] = {rays[i].tMax, shared::kMiss, 0, 0};
      for (uint32_t t = 0; t < m.scene.triangles(); ++t) {
        const uvec3 k = m.scene.indices[t];
        const glm::dvec3 a(m.scene.positions[k.x]), e1 = glm::dvec3(m.scene.positions[k.y]) - a, e2 = glm::dvec3(m.scene.positions[k.z]) - a;
        const glm::dvec3 d(rays[i].direction), s = glm::dvec3(rays[i].origin) - a, p = glm::cross(d, e2), q = glm::cross(s, e1);
        const double det = glm::dot(e1, p);
        if (det == 0) continue;
        const double u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, distance = glm::dot(e2, q) / det;
        if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= static_cast<double>(hits[i].t)) continue;
        hits[i] = {static_cast<float>(distance), t, static_cast<float>(u), static_cast<float>(v)};
      }
    }
  };
  const Atlas atlas = buildAtlas(m.scene, settings, pool, progress, insideTest(m.scene, pool, 1e-4f, cast));
  EXPECT_GT(atlas.report.insideTexels, 0u);
  EXPECT_EQ(atlas.report.insideTexels + atlas.report.validTexels, atlas.report.coveredTexels);
  for (const Lumel& l : atlas.lumels) {
    const bool onFloor = l.triangle < 2;
    const bool under = std::abs(l.position.x - 0.07f) < 0.5f && std::abs(l.position.z + 0.03f) < 0.5f;
    EXPECT_FALSE(onFloor && under) << l.position.x << ' ' << l.position.z;
  }
  // One square metre of the sixteen lies under the box.
  double floor = 0;
  for (const Lumel& l : atlas.lumels) floor += l.triangle < 2 ? static_cast<double>(l.area) : 0;
  EXPECT_NEAR(floor, 15, 0.05);
  // Texels that the box covers in part lie where their open part is: none is farther from the box's foot than half a texel more than it need be.
  EXPECT_GT(atlas.report.openedTexels, 8u);
  // The lid of the box and its sides stay.
  EXPECT_NEAR(areaOfLumels(atlas) - floor, 6, 1e-3);
  EXPECT_EQ(std::count(atlas.texelState.begin(), atlas.texelState.end(), TexelInside), static_cast<int64_t>(atlas.report.insideTexels));
}

TEST(Atlas, TooFewTexelsAreReported) {
  Maker m;
  for (int i = 0; i < 400; ++i) {
    const float x = static_cast<float>(i);
    m.triangle(m.vertex(vec3(3 * x, 0, 0)), m.vertex(vec3(3 * x + 1, 0, 0)), m.vertex(vec3(3 * x, 1, 0)));
  }
  const Atlas atlas = build(m.scene, 16);
  EXPECT_EQ(atlas.report.droppedCharts, 144u);
  EXPECT_NEAR(atlas.report.uncoveredArea, 72, 1e-3);
  EXPECT_EQ(atlas.lumels.size(), 256u);
}

TEST(Atlas, AlbedoAndEmissionAreMeansByArea) {
  Maker m;
  m.scene.hasUvs = true;
  Texture texture;
  texture.width = 2, texture.height = 1;
  texture.srgb = false;
  texture.rgba = {255, 0, 0, 255, 0, 255, 0, 255};
  m.scene.textures.push_back(texture);
  m.scene.materials[0].albedo = vec3(0.5f);
  m.scene.materials[0].albedoTexture = 0;
  m.scene.materials[0].emission = vec3(3, 2, 1);
  m.quad(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0), vec2(0.0f), vec2(1.0f));
  const Atlas atlas = build(m.scene, 1);
  ASSERT_EQ(atlas.lumels.size(), 1u);
  EXPECT_NEAR(atlas.lumels[0].albedo.x, 0.25, 0.04);
  EXPECT_NEAR(atlas.lumels[0].albedo.y, 0.25, 0.04);
  EXPECT_EQ(atlas.lumels[0].albedo.z, 0);
  EXPECT_EQ(atlas.lumels[0].emission, vec3(3, 2, 1));
}

TEST(Atlas, SameWhateverTheThreads) {
  Maker m;
  m.sphere(vec3(0), 1, 16, 32);
  m.box(vec3(3, 0, 0), vec3(1, 2, 3));
  const Atlas one = build(m.scene, 96, 1), four = build(m.scene, 96, 4);
  ASSERT_EQ(one.lumels.size(), four.lumels.size());
  EXPECT_EQ(std::memcmp(one.lumels.data(), four.lumels.data(), one.lumels.size() * sizeof(Lumel)), 0);
  EXPECT_EQ(std::memcmp(one.cornerUvs.data(), four.cornerUvs.data(), one.cornerUvs.size() * sizeof(vec2)), 0);
}

TEST(Atlas, EmptySceneAndSingleTriangle) {
  Maker none;
  const Atlas empty = build(none.scene, 32);
  EXPECT_TRUE(empty.lumels.empty());
  EXPECT_EQ(empty.lumelOfTexel.size(), 1024u);
  Maker one;
  one.triangle(one.vertex(vec3(0)), one.vertex(vec3(1, 0, 0)), one.vertex(vec3(0, 1, 0)));
  one.triangle(one.vertex(vec3(0)), one.vertex(vec3(0)), one.vertex(vec3(0)));  // without area
  const Atlas atlas = build(one.scene, 32);
  EXPECT_NEAR(areaOfLumels(atlas), 0.5, 1e-6);
  EXPECT_EQ(atlas.charts[1], kNone);
}

TEST(Atlas, StopsWhenCancelled) {
  Maker m;
  m.box(vec3(0), vec3(1));
  TaskPool pool(2);
  Progress progress;
  progress.cancel();
  try {
    buildAtlas(m.scene, {}, pool, progress);
    FAIL() << "was not cancelled";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::Cancelled);
  }
}

TEST(Raster, SharedEdgesAreOwnedOnce) {
  // Sample points on edges and corners of a fan: each inner point belongs to exactly one triangle.
  const glm::dvec2 centre(4, 4);
  const glm::dvec2 ring[] = {{0, 0}, {4, 0}, {8, 0}, {8, 4}, {8, 8}, {4, 8}, {0, 8}, {0, 4}};
  for (int y = 1; y < 8; ++y) {
    for (int x = 1; x < 8; ++x) {
      int owners = 0;
      for (int i = 0; i < 8; ++i) owners += OwnershipTest(centre, ring[i], ring[(i + 1) % 8]).owns({x, y});
      // The corner that all eight share may be owned by two opposite ones at most; everything else by exactly one.
      if (x == 4 && y == 4) continue;
      EXPECT_EQ(owners, 1) << x << ' ' << y;
    }
  }
}

TEST(Packing, RectanglesStayApart) {
  std::vector<glm::dvec2> sizes;
  uint32_t state = 7;
  const auto random = [&] { return static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) / (1 << 24); };
  for (int i = 0; i < 200; ++i) sizes.push_back({0.1 + 3 * random(), 0.1 + random()});
  Progress progress;
  const Packing packing = packRectangles(sizes, 128, 2, progress);
  std::vector<int> owner(128 * 128, -1);
  for (size_t i = 0; i < sizes.size(); ++i) {
    const Placement& p = packing.placements[i];
    ASSERT_TRUE(p.placed);
    EXPECT_GE(p.origin.x, p.cell.x);
    EXPECT_LE(p.origin.x + sizes[i].x * p.scale.x, p.cell.x + p.cellSize.x);
    for (int y = p.cell.y; y < p.cell.y + p.cellSize.y; ++y) {
      for (int x = p.cell.x; x < p.cell.x + p.cellSize.x; ++x) {
        ASSERT_TRUE(x < 128 && y < 128);
        for (int dy = -packing.margin; dy <= packing.margin; ++dy)
          for (int dx = -packing.margin; dx <= packing.margin; ++dx) {
            const int u = x + dx, v = y + dy;
            if (u < 0 || v < 0 || u >= 128 || v >= 128) continue;
            const int o = owner[static_cast<size_t>(v * 128 + u)];
            ASSERT_TRUE(o < 0 || o == static_cast<int>(i));
          }
      }
    }
    for (int y = p.cell.y; y < p.cell.y + p.cellSize.y; ++y)
      for (int x = p.cell.x; x < p.cell.x + p.cellSize.x; ++x) owner[static_cast<size_t>(y * 128 + x)] = static_cast<int>(i);
  }
}

}  // namespace
}  // namespace hl
