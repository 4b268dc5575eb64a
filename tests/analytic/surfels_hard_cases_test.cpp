// What strains the surfel cache: full memory, full cells, no rays, Inf, a camera that jumps; and that two runs agree to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "engine/scene/scene_file.h"
#include "tests/surfels_harness.h"

namespace hl::test {
namespace {

void small(SurfelsHarness& h) { h.set("surfels.max_surfels", "4096").set("surfels.radius_pixels", "3").set("surfels.place_chance", "1"); }

bool finite(const Image& image) {
  for (const float v : image.data)
    if (!std::isfinite(v)) return false;
  return true;
}

TEST(SurfelHardCase, TwoRunsAgreeToTheBitWhateverMoves) {
  const Scene scene = loadScene("cornell_box");
  std::vector<float> first;
  for (const char* tracer : {"embree", "embree", "bvh"}) {
    SurfelsHarness h(scene, tracer);
    small(h);
    h.set("surfels.guiding", "true").set("surfels.ray_budget", "2").set("surfels.recycle_chance", "0.5").set("surfels.recycle_coverage", "1.5").set("surfels.radius_max", "0.2");
    h.rebuild();
    Camera c = scene.cameras.front();
    for (int i = 0; i < 24; ++i) {
      c.position = c.position - vec3(0.01f, 0.005f, 0.06f);
      h.frame(c);
    }
    for (int i = 0; i < 12; ++i) h.frame(c);  // and stands
    EXPECT_GT(h.counter("recycled"), 0);
    const Image image = h.irradiance();
    ASSERT_TRUE(finite(image));
    if (first.empty()) {
      first = image.data;
    } else if (std::string(tracer) == "embree") {
      EXPECT_EQ(std::memcmp(first.data(), image.data.data(), first.size() * sizeof(float)), 0);
    }
  }
}

/// Tiles list all that reach their pixels, in the grid's order: the same picture to the bit, from either grid, while cameras and surfels move.
TEST(SurfelHardCase, DrawnSurfelsGiveTheGridsPicture) {
  const Scene scene = loadScene("cornell_box");
  for (const char* grid : {"uniform", "camera"}) {
    std::vector<float> first;
    for (const char* gather : {"per_pixel", "splat"}) {
      SurfelsHarness h(scene);
      small(h);
      h.width = 61, h.height = 43;  // tiles that the picture cuts
      h.set("surfels.grid", grid).set("surfels.gather", gather).set("surfels.radius_max", "0.1");
      h.rebuild();
      Camera c = scene.cameras.front();
      for (int i = 0; i < 12; ++i) {
        c.position = c.position + vec3(0.01f, 0, 0.05f);
        h.frame(c);
      }
      const Image image = h.irradiance();
      ASSERT_TRUE(finite(image));
      EXPECT_GT(h.mean(), 0);
      EXPECT_EQ(h.counter("dropped_lists"), 0);
      if (first.empty()) first = image.data;
      EXPECT_EQ(std::memcmp(first.data(), image.data.data(), first.size() * sizeof(float)), 0) << grid << ", " << gather;
    }
  }
}

/// A frozen cache keeps its surfels; a plain mean over it goes on converging, where a window's noise levels off. Without a freeze it is refused.
TEST(SurfelHardCase, APlainMeanNeedsAFrozenCache) {
  SurfelsHarness h(loadScene("cornell_box"));
  small(h);
  h.set("surfels.estimator", "mean");
  try {
    h.rebuild();
    ADD_FAILURE() << "a plain mean over a cache that never freezes was taken";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("freeze_frames"), std::string::npos) << e.what();
  }
  double variation[2] = {0, 0};
  for (const bool mean : {false, true}) {
    h.set("surfels.estimator", mean ? "mean" : "multi_scale").set("surfels.freeze_frames", "60").set("surfels.min_blend", "0.05");
    h.rebuild();
    for (int i = 0; i < 60; ++i) h.frame(h.scene.cameras.front());
    h.frame(h.scene.cameras.front());
    const double surfels = h.counter("surfels"), placed = h.counter("placed_at_pixels") + h.counter("placed_at_hits");
    EXPECT_GT(surfels, 0);
    for (int i = 0; i < 60; ++i) h.frame(h.scene.cameras.front());
    EXPECT_EQ(h.counter("surfels"), surfels);
    EXPECT_EQ(h.counter("placed_at_pixels") + h.counter("placed_at_hits"), placed);
    const Image a = h.irradiance();
    for (int i = 0; i < 20; ++i) h.frame(h.scene.cameras.front());
    const Image b = h.irradiance();
    ASSERT_TRUE(finite(b));
    for (size_t i = 0; i < a.data.size(); i += 4) variation[mean] += static_cast<double>((a.data[i] - b.data[i]) * (a.data[i] - b.data[i]));
  }
  std::printf("frozen: within 20 frames a mean moves by %.3g of what a window of 1/20 does\n", std::sqrt(variation[1] / variation[0]));
  EXPECT_LT(variation[1], 0.25 * variation[0]);
}

TEST(SurfelHardCase, FullMemoryPlacesNoMoreAndSaysSo) {
  SurfelsHarness h(loadScene("cornell_box"));
  small(h);
  h.set("surfels.max_surfels", "1024").set("surfels.radius_pixels", "1");
  h.width = h.height = 96;
  h.rebuild();
  for (int i = 0; i < 40; ++i) h.frame(h.scene.cameras.front());
  EXPECT_EQ(h.counter("surfels"), 1024);
  EXPECT_GT(h.counter("max_surfels_reached"), 0);
  EXPECT_TRUE(finite(h.irradiance()));
}

TEST(SurfelHardCase, FullCellsAreCutTheSameInEveryFrame) {
  SurfelsHarness h(loadScene("furnace_box_050"));
  small(h);
  h.set("surfels.cell_limit", "8").set("surfels.place_every", "1").set("surfels.radius_max", "0.2").set("surfels.hit_reach", "1");  // else what the limit hides from pixels reaches farther
  h.rebuild();
  for (int i = 0; i < 60; ++i) h.frame(h.scene.cameras.front());
  EXPECT_GT(h.counter("cell_overflows"), 0);
  h.set("surfels.ray_budget", "0").set("surfels.place_chance", "0").set("surfels.recycle", "false");
  h.frame(h.scene.cameras.front());
  const Image a = h.irradiance();
  h.frame(h.scene.cameras.front());
  const Image b = h.irradiance();
  EXPECT_EQ(std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)), 0);
  EXPECT_GT(h.mean(), 0);
}

/// While nothing moves lists are made in one of place_every frames, and read as if they were made in each; a camera that moves finds new ones at once.
TEST(SurfelHardCase, ListsStandWhileNothingMoves) {
  SurfelsHarness h(loadScene("furnace_box_050"));
  small(h);
  const auto listed = [&] {
    return std::any_of(h.last.passes.begin(), h.last.passes.end(), [](const PassTiming& p) { return p.name == "surfels: sort cells" && p.skipped.empty(); });
  };
  h.set("surfels.place_every", "6");
  h.rebuild();
  Camera c = h.scene.cameras.front();
  for (int i = 0; i < 60; ++i) h.frame(c);
  int lists = 0;
  for (int i = 0; i < 24; ++i) h.frame(c), lists += listed() ? 1 : 0;
  EXPECT_GE(lists, 4);
  EXPECT_LT(lists, 12);
  h.set("surfels.ray_budget", "0").set("surfels.place_chance", "0").set("surfels.recycle", "false").set("surfels.place_every", "1000");
  h.frame(c);  // the last that may list what was placed before
  h.frame(c);
  EXPECT_FALSE(listed());
  const Image kept = h.irradiance();
  h.set("surfels.place_every", "1");
  for (int i = 0; i < 2; ++i) h.frame(c);
  EXPECT_TRUE(listed());
  const Image made = h.irradiance();
  EXPECT_EQ(std::memcmp(kept.data.data(), made.data.data(), kept.data.size() * sizeof(float)), 0);
  h.set("surfels.place_every", "1000");
  for (int i = 0; i < 2; ++i) h.frame(c);
  EXPECT_FALSE(listed());
  c.position.x += 0.01f;
  h.frame(c);
  EXPECT_TRUE(listed());
}

/// Once nothing has changed for long, rays are cast and pixels gather in some frames only; whatever changes ends it at once.
TEST(SurfelHardCase, ASettledCacheRestsUntilSomethingChanges) {
  SurfelsHarness h(loadScene("point_light_cube"));
  small(h);
  h.set("surfels.settle_frames", "40").set("surfels.young_rays", "0").set("surfels.settled_every", "4");
  h.rebuild();
  Camera c = h.scene.cameras.front();
  const auto raysAFrame = [&](int frames) {
    const double before = h.counter("surfel_rays");
    for (int i = 0; i < frames; ++i) h.frame(c);
    return (h.counter("surfel_rays") - before) / frames / h.counter("surfels");
  };
  const auto same = [](const Image& a, const Image& b) { return std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0; };
  for (int i = 0; i < 24; ++i) h.frame(c);
  EXPECT_NEAR(raysAFrame(16), 1, 0.1);
  EXPECT_NEAR(raysAFrame(8), 0.25, 0.03);
  EXPECT_EQ(h.counter("uncovered_pixels"), 0);
  int pictures = 0;
  Image last = h.irradiance();
  for (int i = 0; i < 8; ++i) {
    h.frame(c);
    const Image now = h.irradiance();
    if (!same(now, last)) ++pictures;
    last = now;
  }
  EXPECT_EQ(pictures, 2);
  const double lit = h.mean();
  EXPECT_GT(h.counter("surfels_in_view"), 0.3 * h.counter("surfels"));  // none is forgotten in frames that gather nothing

  for (PointLight& l : h.scene.pointLights) l.intensity *= 2.0f;
  h.lightsEdited();
  EXPECT_NEAR(raysAFrame(1), 1, 0.1);
  EXPECT_FALSE(same(h.irradiance(), last));
  EXPECT_NEAR(raysAFrame(38), 1, 0.1);
  EXPECT_NEAR(h.mean() / lit, 2, 0.05);
  for (int i = 0; i < 8; ++i) h.frame(c);
  EXPECT_NEAR(raysAFrame(8), 0.25, 0.03);
  h.set("surfels.coverage", "0.9");
  EXPECT_NEAR(raysAFrame(1), 1, 0.1);

  // A camera that moves finds all surfels and sees its picture at once: the one that the other way round gives, too.
  h.set("surfels.ray_budget", "0").set("surfels.place_chance", "0").set("surfels.recycle", "false");
  h.frame(c);
  last = h.irradiance();
  c.position.x += 0.02f;
  h.frame(c);
  EXPECT_FALSE(same(h.irradiance(), last));
  EXPECT_EQ(h.counter("uncovered_pixels"), 0);
}

TEST(SurfelHardCase, NoRaysKeepTheCacheAsItIs) {
  SurfelsHarness h(loadScene("cornell_box"));
  small(h);
  h.set("surfels.ray_budget", "0");
  h.rebuild();
  for (int i = 0; i < 10; ++i) h.frame(h.scene.cameras.front());
  EXPECT_EQ(h.mean(), 0);
  EXPECT_GT(h.counter("surfels"), 0);
  EXPECT_EQ(h.counter("surfel_rays"), 0);
  h.set("surfels.ray_budget", "1");
  for (int i = 0; i < 10; ++i) h.frame(h.scene.cameras.front());
  const double lit = h.mean();
  EXPECT_GT(lit, 0);
  EXPECT_GT(h.counter("surfel_rays"), 0);
  h.set("surfels.ray_budget", "0").set("surfels.place_chance", "0").set("surfels.recycle", "false");
  for (int i = 0; i < 5; ++i) h.frame(h.scene.cameras.front());
  EXPECT_NEAR(h.mean(), lit, 0.2 * lit);
}

TEST(SurfelHardCase, InfAndNanAreCountedAndNeverEnterAnEstimate) {
  Scene scene = loadScene("point_light_cube");
  SurfelsHarness h(scene);
  small(h);
  h.rebuild();
  const Camera camera = scene.cameras.front();
  for (int i = 0; i < 20; ++i) h.frame(camera);
  const double before = h.mean();
  ASSERT_GT(before, 0);
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    h.scene.pointLights[0].intensity = vec3(bad);
    h.lightsEdited();
    for (int i = 0; i < 3; ++i) h.frame(camera);
    EXPECT_TRUE(finite(h.irradiance()));
  }
  EXPECT_GT(h.counter("surfel_inf") + h.counter("surfel_nan"), 0);
  const double counted = h.counter("surfel_inf") + h.counter("surfel_nan");
  h.scene.pointLights[0].intensity = scene.pointLights[0].intensity;
  h.lightsEdited();
  for (int i = 0; i < 60; ++i) h.frame(camera);
  EXPECT_EQ(h.counter("surfel_inf") + h.counter("surfel_nan"), counted);
  EXPECT_TRUE(finite(h.irradiance()));
  EXPECT_GT(h.mean(), 0.9 * before);
}

/// A guide that follows what a sequence of points has found, and a sequence that goes on regardless, are not independent: 6 % too much light here.
TEST(SurfelHardCase, GuidedRaysBringTheSameLight) {
  double light[2] = {0, 0};
  for (const bool guided : {false, true}) {
    SurfelsHarness h(loadScene("cornell_box"));
    small(h);
    h.set("surfels.guiding", guided ? "true" : "false").set("surfels.ray_budget", "4").set("surfels.young_rays", "0");
    h.width = h.height = 48;
    h.rebuild();
    for (int i = 0; i < 120; ++i) {
      h.frame(h.scene.cameras.front());
      if (i % 10 == 9 && i >= 59) light[guided] += h.mean();
    }
  }
  std::printf("guided: %.4f of the light\n", light[1] / light[0]);
  EXPECT_NEAR(light[1] / light[0], 1, 0.015);
}

/// A limit in deviations of what has never varied would be 0, and what has seen only black so far would stay black for ever.
TEST(SurfelHardCase, AFireflyLimitLetsTheFirstLightIn) {
  SurfelsHarness h(loadScene("furnace_box_050"));
  small(h);
  h.set("surfels.firefly_limit", "8").set("surfels.change_samples", "0");
  h.width = h.height = 32;
  const float emission = h.scene.materials.front().emission.x;
  for (Material& m : h.scene.materials) m.emission = vec3(0.0f);
  h.rebuild();
  for (int i = 0; i < 40; ++i) h.frame(h.scene.cameras.front());
  EXPECT_EQ(h.mean(), 0);
  h.shine(emission);
  for (int i = 0; i < 60; ++i) h.frame(h.scene.cameras.front());
  EXPECT_GT(h.mean(), 0.8 * static_cast<double>(kPi * emission));  // pi rho / (1 - rho) times emission in the end
  EXPECT_EQ(h.counter("surfel_nan"), 0);
}

TEST(SurfelHardCase, AJumpingCameraFindsLightAtOnceWhereRaysHavePlacedSurfels) {
  SurfelsHarness h(loadScene("furnace_box_080"));
  small(h);
  h.set("surfels.ray_budget", "4");
  h.rebuild();
  Camera away = h.scene.cameras.front(), back = away;
  back.position = vec3(-0.2f, 1, -0.7f), back.target = vec3(0.1f, 0.9f, 1);
  for (int i = 0; i < 60; ++i) h.frame(away);
  const double settled = h.mean();
  h.frame(back);
  std::printf("jump: %.4f of the light at once, %.0f pixels without\n", h.mean() / settled, h.counter("uncovered_pixels"));
  EXPECT_GT(h.mean(), 0.5 * settled);
  for (int i = 0; i < 20; ++i) h.frame(back);
  EXPECT_NEAR(h.mean() / settled, 1, 0.05);
  EXPECT_EQ(h.counter("unlit_pixels"), 0);
}

TEST(SurfelHardCase, WithoutSurfelsAtHitsUnseenWallsLoseBouncesAndAreCounted) {
  double light[2] = {0, 0}, uncovered[2] = {0, 0};
  for (const bool spawn : {false, true}) {
    SurfelsHarness h(loadScene("furnace_box_080"));
    small(h);
    h.set("surfels.spawn_at_hits", spawn ? "true" : "false").set("surfels.ray_budget", "4").set("surfels.young_rays", "0");
    h.rebuild();
    for (int i = 0; i < 60; ++i) h.frame(h.scene.cameras.front());
    light[spawn] = h.mean(), uncovered[spawn] = h.counter("uncovered_hits_last_frame") / h.counter("surfels");
  }
  std::printf("unseen walls: %.3f of the light without surfels there, %.2f uncovered hits a surfel and frame; with them %.4f\n", light[0] / light[1], uncovered[0], uncovered[1]);
  EXPECT_LT(light[0], 0.8 * light[1]);
  EXPECT_GT(uncovered[0], 10 * uncovered[1]);
}

}  // namespace
}  // namespace hl::test
