// The lightmap at pixels: bilinear within a chart, nothing across seams, front faces alone; dilation; views; picking.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "engine/scene/scene_file.h"
#include "tests/technique_harness.h"

namespace hl::test {
namespace {

/// A G-buffer made by hand, one pixel a surface point.
struct Pixel {
  uint32_t triangle = 0;
  vec2 lightmapUv{0.0f};
  float side = 1;  ///< position.w
};

class HandMadeGBuffer {
 public:
  HandMadeGBuffer(TechniqueHarness& h, const std::vector<Pixel>& pixels) {
    g.width = static_cast<int>(pixels.size()), g.height = 1;
    const auto image = [&](const char* name, Format format) { return h.device->image(name, {g.width, 1, format}); };
    g.position = image("test position", Format::RGBA32F);
    g.normal = image("test normal", Format::RGBA32F);
    g.geometricNormal = image("test geometric normal", Format::RGBA32F);
    g.ids = image("test ids", Format::RG32U);
    std::vector<vec4> position, normal, geometric;
    std::vector<uvec2> ids;
    for (const Pixel& p : pixels) {
      position.push_back(vec4(0, 0, 0, p.side));
      normal.push_back(vec4(0, 0, 1, p.lightmapUv.x));
      geometric.push_back(vec4(0, 0, 1, p.lightmapUv.y));
      ids.push_back(uvec2(p.side == 0 ? 0 : p.triangle + 1, 0));
    }
    h.device->upload(g.position, 0, position.data(), position.size() * sizeof(vec4));
    h.device->upload(g.normal, 0, normal.data(), normal.size() * sizeof(vec4));
    h.device->upload(g.geometricNormal, 0, geometric.data(), geometric.size() * sizeof(vec4));
    h.device->upload(g.ids, 0, ids.data(), ids.size() * sizeof(uvec2));
  }
  GBuffer g;
};

std::vector<float> atPixels(TechniqueHarness& h, const std::vector<Pixel>& pixels, std::string_view view = {}) {
  const HandMadeGBuffer made(h, pixels);
  const IndirectLight light = h.technique->record(*h.graph, {made.g, 0, 1, view});
  h.graph->execute();
  const Image image = h.device->download(light.irradiance);
  std::vector<float> green;
  for (size_t i = 0; i < pixels.size(); ++i) green.push_back(image.data[4 * i + 1]);
  return green;
}

/// The point-light cube, little lightmap, one bounce: neighbouring faces meet at seams.
void prepare(TechniqueHarness& h) {
  h.set("lightmap.resolution", "32").set("radiosity.samples", "64").set("radiosity.bounces", "2");
  h.rebuild();
  h.work();
}

TEST(RadiosityApply, BilinearBetweenTexelCentresOfTheSameChart) {
  TechniqueHarness h("radiosity", loadScene("point_light_cube"));
  prepare(h);
  const std::vector<vec3> e = h.technique->lightmapIrradiance();
  const int side = h.atlas.resolution;
  std::vector<Pixel> pixels;
  std::vector<double> expected;
  for (int y = 0; y + 1 < side; ++y) {
    for (int x = 0; x + 1 < side; ++x) {
      uint32_t lumel[4];
      bool whole = true;
      for (int k = 0; k < 4; ++k) {
        lumel[k] = h.atlas.lumelOfTexel[static_cast<size_t>((y + k / 2) * side + x + k % 2)];
        whole = whole && lumel[k] != kNone && h.atlas.charts[h.atlas.lumels[lumel[k]].triangle] == h.atlas.charts[h.atlas.lumels[lumel[0]].triangle];
      }
      if (!whole) continue;
      const vec2 f(0.25f, 0.625f);
      pixels.push_back({h.atlas.lumels[lumel[0]].triangle, (vec2(static_cast<float>(x), static_cast<float>(y)) + 0.5f + f) / static_cast<float>(side), 1});
      const auto value = [&](int k) { return static_cast<double>(e[lumel[k]].y); };
      expected.push_back(0.375 * (0.75 * value(0) + 0.25 * value(1)) + 0.625 * (0.75 * value(2) + 0.25 * value(3)));
    }
  }
  ASSERT_GT(pixels.size(), 200u);
  const std::vector<float> got = atPixels(h, pixels);
  for (size_t i = 0; i < pixels.size(); ++i) ASSERT_NEAR(got[i] / expected[i], 1, 1e-5) << i;
  EXPECT_EQ(h.counter("pixels_without_texel"), 0);

  h.set("radiosity.lookup", "nearest");
  const std::vector<float> nearestTexel = atPixels(h, pixels);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const ivec2 t(pixels[i].lightmapUv * static_cast<float>(side));
    const uint32_t lumel = h.atlas.lumelOfTexel[static_cast<size_t>(t.y * side + t.x)];
    ASSERT_EQ(nearestTexel[i], e[lumel].y) << i;
  }
}

/// Two rooms back to back, one lit and one dark, whose floors touch in the lightmap: nothing crosses.
TEST(RadiosityApply, NothingCrossesASeam) {
  Scene scene;
  scene.materials.push_back({});
  scene.objects = {"rooms"};
  const auto quad = [&](vec3 a, vec3 u, vec3 v, vec2 low, vec2 high) {
    const auto base = static_cast<uint32_t>(scene.positions.size());
    const vec2 uvs[] = {low, vec2(high.x, low.y), high, vec2(low.x, high.y)};
    int k = 0;
    for (vec3 p : {a, a + u, a + u + v, a + v}) {
      scene.positions.push_back(p);
      scene.normals.push_back(glm::normalize(glm::cross(u, v)));
      scene.uvs.push_back(vec2(0.0f));
      scene.lightmapUvs.push_back(uvs[k++]);
      scene.bounds.extend(p);
    }
    for (uvec3 t : {uvec3(0, 1, 2), uvec3(0, 2, 3)}) {
      scene.indices.push_back(t + base);
      scene.materialIds.push_back(0);
      scene.objectIds.push_back(0);
    }
  };
  // Floors facing up under roofs facing down; the lit pair's charts lie next to the dark pair's without a gap.
  quad(vec3(-1, 0, 1), vec3(2, 0, 0), vec3(0, 0, -2), vec2(0, 0), vec2(0.5f, 0.5f));
  quad(vec3(-1, 1, -1), vec3(2, 0, 0), vec3(0, 0, 2), vec2(0, 0.5f), vec2(0.5f, 1));
  quad(vec3(99, 0, 1), vec3(2, 0, 0), vec3(0, 0, -2), vec2(0.5f, 0), vec2(1, 0.5f));
  quad(vec3(99, 1, -1), vec3(2, 0, 0), vec3(0, 0, 2), vec2(0.5f, 0.5f), vec2(1, 1));
  PointLight lamp;
  lamp.position = vec3(0, 0.5f, 0);
  scene.pointLights = {lamp};
  TechniqueHarness h("radiosity", scene);
  h.set("direct.ray_offset", "1e-6");
  prepare(h);
  ASSERT_FALSE(h.atlas.report.ownCharts);
  ASSERT_EQ(h.atlas.report.charts, 4u);
  // Along the seam between the lit floor (triangles 0, 1) and the dark one (4, 5), a thousandth of a texel on either side.
  std::vector<Pixel> pixels;
  for (int i = 0; i < 30; ++i) {
    const float v = (static_cast<float>(i) + 0.5f) / 64;
    pixels.push_back({0, vec2(0.5f - 1e-5f, v), 1});
    pixels.push_back({4, vec2(0.5f + 1e-5f, v), 1});
  }
  const std::vector<float> got = atPixels(h, pixels);
  for (size_t i = 0; i < got.size(); i += 2) {
    EXPECT_GT(got[i], 0.01f) << i;
    // A trickle comes from the lit room 100 m away through the open sides, no more.
    EXPECT_LT(got[i + 1], 1e-4f * got[i]) << i;
  }
}

TEST(RadiosityApply, BackFacesAndTheOpenGetNothing) {
  TechniqueHarness h("radiosity", loadScene("point_light_cube"));
  prepare(h);
  const Lumel& l = h.atlas.lumels[h.atlas.lumels.size() / 2];
  const float side = static_cast<float>(h.atlas.resolution);
  const vec2 uv((static_cast<float>(l.texel % h.atlas.resolution) + 0.5f) / side, (static_cast<float>(l.texel / h.atlas.resolution) + 0.5f) / side);
  const std::vector<float> got = atPixels(h, {{l.triangle, uv, 1}, {l.triangle, uv, -1}, {0, vec2(0.0f), 0}});
  EXPECT_GT(got[0], 0);
  EXPECT_EQ(got[1], 0);
  EXPECT_EQ(got[2], 0);
}

TEST(RadiosityApply, DilationCarriesTheSlopeOnAndThenTakesTheMean) {
  for (const int rings : {0, 1, 2, 3}) {
    TechniqueHarness h("radiosity", loadScene("point_light_cube"));
    h.set("lightmap.dilation", std::to_string(rings));
    prepare(h);
    atPixels(h, {{0, vec2(0.5f), 1}});
    GpuImage map;
    for (const DebugView& v : h.technique->debugViews())
      if (v.id == "lightmap") map = v.image;
    const Image image = h.device->download(map);
    const std::vector<vec3> e = h.technique->lightmapIrradiance();
    const int side = h.atlas.resolution;
    // The same on the host, from the definition.
    std::vector<vec4> values(static_cast<size_t>(side * side), vec4(0.0f));
    for (size_t i = 0; i < e.size(); ++i) values[h.atlas.lumels[i].texel] = vec4(e[i].x, e[i].y, e[i].z, 1);
    const auto chartAt = [&](int x, int y) {
      return h.atlas.charts[h.atlas.lumels[h.atlas.lumelOfTexel[static_cast<size_t>(y * side + x)]].triangle];
    };
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<vec4> next = values;
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          if (values[static_cast<size_t>(y * side + x)].w > 0) continue;
          vec4 sum(0.0f);
          const auto at = [&](int u, int v) {
            return u >= 0 && v >= 0 && u < side && v < side ? values[static_cast<size_t>(v * side + u)] : vec4(0.0f);
          };
          std::set<uint32_t> charts;
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
              if (ring == 0 && at(x + dx, y + dy).w > 0) charts.insert(chartAt(x + dx, y + dy));
          for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
              const vec4 next1 = at(x + dx, y + dy), next2 = at(x + 2 * dx, y + 2 * dy);
              const bool slope = charts.size() == 1 && next1.w > 0 && next2.w > 0 && chartAt(x + dx, y + dy) == chartAt(x + 2 * dx, y + 2 * dy);
              sum += slope ? vec4(glm::max(2.0f * vec3(next1.x, next1.y, next1.z) - vec3(next2.x, next2.y, next2.z), vec3(0.0f)), 1.0f) : next1;
            }
          }
          if (sum.w > 0) next[static_cast<size_t>(y * side + x)] = sum / sum.w;
        }
      }
      values = next;
    }
    size_t dilated = 0, compared = 0;
    for (size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(image.data[4 * i + 3], values[i].w) << i;
      if (values[i].w > 0 && h.atlas.lumelOfTexel[i] == kNone) ++dilated;
      // The cube's charts are a few texels apart: with one ring no texel has neighbours of two charts.
      if (rings > 1) continue;
      ++compared;
      ASSERT_NEAR(image.data[4 * i + 1], values[i].y, 1e-5f * std::abs(values[i].y)) << i;
    }
    EXPECT_EQ(dilated > 0, rings > 0);
    EXPECT_EQ(compared > 0, rings <= 1);
  }
}

TEST(RadiosityApply, TowardsInvalidTexelsPixelsStayWithinHalfOfTheirNeighbours) {
  // Texels inside the short block's footprint are invalid; the floor's seam with the block must be neither black nor bright.
  TechniqueHarness h("radiosity", loadScene("cornell_box"));
  h.set("lightmap.resolution", "64").set("radiosity.samples", "128").set("radiosity.bounces", "3").set("direct.lumel_samples", "16");
  h.rebuild();
  h.work();
  ASSERT_GT(h.counter("invalid_texels"), 0);
  const std::vector<vec3> e = h.technique->lightmapIrradiance();
  const int side = h.atlas.resolution;
  const auto lumelAt = [&](int x, int y) { return h.atlas.lumelOfTexel[static_cast<size_t>(y * side + x)]; };
  std::vector<Pixel> pixels;
  std::vector<float> own, most;
  for (int y = 1; y + 1 < side; ++y) {
    for (int x = 1; x + 1 < side; ++x) {
      if (h.atlas.texelState[static_cast<size_t>(y * side + x)] != TexelInside) continue;
      float high = 0;
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u)
          if (lumelAt(u, v) != kNone) high = std::max(high, e[lumelAt(u, v)].y);
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const uint32_t lumel = lumelAt(x + dx, y + dy);
        if (lumel == kNone) continue;
        // Half-way to it: on the rim of the valid texel.
        const vec2 at(static_cast<float>(x) + 0.5f + 0.5f * static_cast<float>(dx), static_cast<float>(y) + 0.5f + 0.5f * static_cast<float>(dy));
        pixels.push_back({h.atlas.lumels[lumel].triangle, at / static_cast<float>(side), 1});
        own.push_back(e[lumel].y), most.push_back(high);
      }
    }
  }
  ASSERT_GT(pixels.size(), 4u);
  const std::vector<float> got = atPixels(h, pixels);
  for (size_t i = 0; i < got.size(); ++i) {
    EXPECT_GE(got[i], 0.499f * own[i]) << i;
    EXPECT_LE(got[i], 0.501f * own[i] + 1.001f * most[i]) << i;
  }
  EXPECT_EQ(h.counter("pixels_without_texel"), 0);
}

TEST(RadiosityViews, ListedBeforeTheyAreMadeAndMadeOnDemand) {
  const auto fresh = techniqueInfo("radiosity").create();
  ASSERT_EQ(fresh->debugViews().size(), 5u);
  TechniqueHarness h("radiosity", loadScene("point_light_cube"));
  prepare(h);
  atPixels(h, {{0, vec2(0.5f), 1}}, "texels");
  for (const DebugView& v : h.technique->debugViews()) {
    EXPECT_TRUE(v.image) << v.id;
    EXPECT_EQ(v.lightmap, v.id != "texels") << v.id;
    EXPECT_EQ(v.image.width(), v.lightmap ? h.atlas.resolution : 1) << v.id;
  }
  uint64_t bytes = 0;
  for (const MemoryItem& m : h.technique->memory()) bytes += m.bytes;
  EXPECT_GT(bytes, h.atlas.lumels.size() * 64 * 4);
}

TEST(RadiosityPick, SamplesAddUpToTheTexel) {
  TechniqueHarness h("radiosity", loadScene("cornell_box"));
  h.set("lightmap.resolution", "48").set("radiosity.samples", "256").set("radiosity.bounces", "3").set("radiosity.residual", "0");
  h.set("direct.lumel_samples", "16");
  h.rebuild();
  h.work();
  const std::vector<vec3> e = h.technique->lightmapIrradiance();
  double worst = 0;
  for (size_t i = 0; i < e.size(); i += e.size() / 7) {
    const Lumel& l = h.atlas.lumels[i];
    PickedPoint p;
    p.position = l.position, p.normal = l.normal, p.triangle = l.triangle;
    const int side = h.atlas.resolution;
    p.lightmapUv = (vec2(static_cast<float>(l.texel % side), static_cast<float>(l.texel / side)) + 0.5f) / static_cast<float>(side);
    const PickReport report = h.technique->pick(p);
    ASSERT_EQ(report.samples.size(), 256u);
    vec3 sum(0.0f);
    for (const PickSample& s : report.samples) {
      sum += kPi * s.weight * s.radiance;
      ASSERT_GT(glm::dot(s.to - s.from, l.normal), -1e-6f);
    }
    // The report shows the radiance after the last bounce: one bounce more than was gathered.
    worst = std::max(worst, std::abs(static_cast<double>(luminance(sum) / luminance(e[i])) - 1));
    EXPECT_GE(luminance(sum), 0.999f * luminance(e[i]));
    EXPECT_FALSE(report.facts.empty());
  }
  EXPECT_LT(worst, 0.3);
  EXPECT_TRUE(h.technique->pick({}).samples.empty());
}

}  // namespace
}  // namespace hl::test
