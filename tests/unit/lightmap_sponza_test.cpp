// The atlas of a large scene that brings no lightmap coordinates.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "engine/lightmap/atlas.h"
#include "engine/scene/scene_file.h"

namespace hl {
namespace {

TEST(Atlas, SponzaAt1024) {
  if (!std::getenv("HALFLIGHT_SCENES")) GTEST_SKIP() << "HALFLIGHT_SCENES is not set: Sponza is not looked for";
  const Scene scene = loadScene("sponza");
  TaskPool pool;
  Progress progress;
  AtlasSettings settings;
  settings.resolution = 1024;
  const Atlas atlas = buildAtlas(scene, settings, pool, progress);
  const AtlasReport& r = atlas.report;
  std::printf("%u charts, coverage %.3f, density spread %.3f, %llu overlapping\n", r.charts, r.coverage, r.densitySpread,
              static_cast<unsigned long long>(r.overlappingTexels));
  EXPECT_TRUE(r.ownCharts);
  EXPECT_EQ(r.droppedCharts, 0u);
  EXPECT_GT(r.coverage, 0.45);
  EXPECT_LT(r.densitySpread, 0.1);
  EXPECT_LE(static_cast<double>(r.overlappingTexels), 1e-3 * static_cast<double>(r.coveredTexels));
  EXPECT_LE(r.uncoveredArea, 1e-3 * r.area);
  // Every triangle with an area lies within the map.
  for (const vec2 uv : atlas.cornerUvs) ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
}

}  // namespace
}  // namespace hl
