// Sparse radiance probes where light leaks, precomputation is stopped, memory is short, or there is nothing to do.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.h"
#include "engine/scene/scene_file.h"
#include "tests/invariances.h"
#include "tests/session_fixture.h"
#include "tests/srp_harness.h"

namespace hl::test {
namespace {

/// Mean of the dark side over that of the bright one, by z.
double leak(const SrpHarness& h, const std::vector<vec3>& e, float lowest, float highest, float parting) {
  double sums[2] = {}, areas[2] = {};
  for (size_t i = 0; i < e.size(); ++i) {
    const Lumel& l = h.atlas.lumels[i];
    if (l.position.z < lowest || l.position.z > highest) continue;
    const int side = l.position.z + 0.005f * l.normal.z > parting ? 1 : 0;
    sums[side] += static_cast<double>(luminance(glm::abs(e[i])) * l.area), areas[side] += static_cast<double>(l.area);
  }
  EXPECT_GT(areas[1], 0);
  EXPECT_GT(sums[0], 0);
  return sums[1] / areas[1] / (sums[0] / areas[0]);
}

TEST(SrpLeaks, NoneThroughAThinWallUncompressed) {
  SrpHarness h(loadScene("thin_wall_tunnel"));
  h.set("lightmap.resolution", "128").set("srp.receiver_rays", "64").set("probes.spacing", "0.1").set("srp.sh_order", "4");
  const double uncompressed = leak(h, h.light(), -1, 5, 2);
  h.set("srp.compression", "cpca").set("srp.pca_vectors", "32");
  const double compressed = leak(h, h.light(), -1, 5, 2);
  // Not dark because nobody asks: nearly all receivers there have probes that see what they see.
  EXPECT_LT(h.counter("invalid_receivers"), 0.01 * h.counter("receivers"));
  std::printf("thin wall: dark side %.2e of the bright one, with 32 vectors a cluster %.2e\n", uncompressed, compressed);
  EXPECT_LE(uncompressed, 1e-3);
  EXPECT_LE(compressed, 1e-3);
}

class SrpSurfaces : public SessionTest {};

/// One probe beside a block: a third of what receivers see it does not see. Radiosity on the same lightmap knows all of it. What is left is what order 7 blurs.
TEST_F(SrpSurfaces, WhatNoProbeSeesIsReadOffTheLightmap) {
  const Scene room = loadScene(litRoom(folder, kTwoLights[0]));
  TechniqueHarness truth("radiosity", room);
  truth.set("lightmap.resolution", "32").set("radiosity.samples", "256");
  const double exact = truth.meanLuminance(truth.bake());
  Scene scene = room;
  scene.probes = {vec3(0.5f, -0.6f, -0.25f)};
  SrpHarness h(scene);
  h.set("srp.least_clusters", "1").set("probes.placement", "manual").set("lightmap.resolution", "32").set("srp.sh_order", "7").set("srp.receiver_rays", "128").set("srp.probe_rays", "500").set("srp.k", "1");
  std::vector<vec3> light[2];
  const auto off = [&](const char* weight, size_t to) {
    h.set("srp.sample_weight", weight);
    light[to] = h.light();
    std::printf("one probe, %s: valid %.3f, %.1f lumels read, mean %+.2f %%\n", weight, h.counter("valid_samples"), h.counter("lumels_read"), 100 * (h.mean(light[to]) / exact - 1));
    return h.mean(light[to]) / exact - 1;
  };
  EXPECT_GT(std::abs(off("valid", 0)), 0.1);
  EXPECT_LT(off("all", 0), -0.1);
  EXPECT_LT(h.counter("valid_samples"), 0.8);
  EXPECT_EQ(h.counter("lumels_read"), 0);
  EXPECT_NEAR(off("surface", 0), 0, 0.04);
  EXPECT_GT(h.counter("lumels_read"), 1);
  // Units that are smaller choose the same lumels.
  h.set("srp.precompute_memory_mb", "2");
  const uint64_t units = h.technique->work().total;
  off("surface", 1);
  EXPECT_GT(h.technique->work().total, units);
  EXPECT_EQ(light[0], light[1]);
}

/// With a lumel for each ray, those that the limit took from probes are those that are read besides.
TEST_F(SrpSurfaces, RaysThatTheBlurLimitSendsToTheLightmapAreCounted) {
  SrpHarness h(loadScene("cornell_box"));
  h.set("lightmap.resolution", "32").set("srp.sh_order", "3").set("srp.receiver_rays", "64").set("srp.surface_reads", "64").set("srp.probe_rays", "256").set("probes.spacing", "0.3");
  double read[3], counted[3];
  const char* limits[] = {"0", "1", "4"};
  for (size_t i = 0; i < 3; ++i) {
    h.set("srp.blur_limit", limits[i]).rebuild();
    h.work();
    read[i] = h.counter("lumels_read") / 64, counted[i] = h.counter("blur_limited_samples");
    std::printf("blur_limit %s: %.4f of the rays are read, %.4f by the limit\n", limits[i], read[i], counted[i]);
  }
  EXPECT_EQ(counted[0], 0);
  EXPECT_GT(counted[1], 0.02);
  EXPECT_LT(counted[2], 0.8 * counted[1]);
  EXPECT_GT(counted[2], 0);
  for (size_t i = 1; i < 3; ++i) EXPECT_NEAR(read[i] - read[0], counted[i], 1e-3) << "but for those where there is no texel";
}

/// Two small squares that face each other, and a probe between that sees them as 17 % of all there is: all that it says is held at kSrpLeastSurface. Of a receiver's rays that is as many as
/// meet the other square. Nearer they are more than half of what it sees, and nothing is.
TEST_F(SrpSurfaces, AnswersThatTheLeastShareHoldsAreCounted) {
  const auto counted = [&](double distance, const char* share) {
    const std::string top = std::to_string(distance), middle = std::to_string(distance / 2);
    SrpHarness h(loadScene(folder.write("squares.json", R"({"version": 1, "lightmap_uvs": true, "shapes": [
        {"type": "quad", "name": "floor", "material": "grey", "corners": [[-0.3, 0, 0.3], [0.3, 0, 0.3], [0.3, 0, -0.3], [-0.3, 0, -0.3]]},
        {"type": "quad", "name": "ceiling", "material": "grey", "corners": [[-0.3, )" + top + ", -0.3], [0.3, " + top + ", -0.3], [0.3, " + top + ", 0.3], [-0.3, " + top + R"(, 0.3]]}],
      "materials": {"grey": {"albedo": 0.5}}, "lights": [{"type": "point", "name": "lamp", "position": [0.05, )" + middle + R"(, 0.2], "intensity": 1}],
      "probes": [[0, )" + middle + ", 0]]}")));
    h.set("probes.placement", "manual").set("lightmap.resolution", "32").set("srp.sh_order", "0").set("srp.receiver_rays", "256").set("srp.blur_limit", "0").set("srp.surface_share", share);
    h.rebuild();
    h.work();
    return h.counter("scarce_surface_samples");
  };
  // Of parallel squares of side a at distance d (form factor, by quadrature).
  double factor = 0;
  constexpr int kSteps = 16;
  for (int i = 0; i < kSteps * kSteps * kSteps * kSteps; ++i) {
    const auto at = [&](int digit) { return 0.6 * ((i / static_cast<int>(std::pow(kSteps, digit))) % kSteps + 0.5) / kSteps; };
    const double x = at(0) - at(1), y = at(2) - at(3), square = x * x + y * y + 1;
    factor += 1 / (static_cast<double>(kPi) * square * square) * 0.36 / (kSteps * kSteps * kSteps * kSteps);
  }
  const double far = counted(1, "true");
  std::printf("squares 1 m apart: %.4f of the rays are held at the least share, form factor %.4f\n", far, factor);
  EXPECT_NEAR(far, factor, 0.05 * factor);
  EXPECT_EQ(counted(1, "false"), 0);
  EXPECT_EQ(counted(0.3, "true"), 0);
}

class SrpWork : public SessionTest {};

TEST_F(SrpWork, GoesOnWhereItWasStopped) {
  const auto harness = [] {
    auto h = std::make_unique<SrpHarness>(loadScene("point_light_cube"));
    h->set("srp.receiver_rays", "64").set("srp.cluster_size", "256").set("srp.cache", "true").set("srp.compression", "cpca").set("srp.sh_order", "2");
    return h;
  };
  std::vector<vec3> whole;
  {
    auto h = harness();
    h->set("srp.cache", "false");
    whole = h->light();
    EXPECT_GE(h->counter("clusters"), 4);
  }
  double first = 0;
  {
    auto h = harness();
    h->rebuild();
    h->work(h->technique->work().total / 2);
    EXPECT_FALSE(h->technique->work().settled());
  }
  {
    auto h = harness();
    const std::vector<vec3> again = h->light();
    first = h->counter("clusters_from_disk");
    EXPECT_GT(first, 0);
    EXPECT_LT(first, h->counter("clusters"));
    EXPECT_EQ(again, whole);
  }
  {
    auto h = harness();
    EXPECT_EQ(h->light(), whole);
    EXPECT_EQ(h->counter("clusters_from_disk"), h->counter("clusters"));
  }
  {
    // Another probe set is another precomputation.
    auto h = harness();
    h->set("probes.spacing", "0.3");
    h->rebuild();
    EXPECT_EQ(h->counter("clusters_from_disk"), 0);
  }
}

TEST_F(SrpWork, TheMemoryThatItMayUseChangesNothingButTime) {
  std::vector<vec3> results[2];
  uint64_t units[2] = {};
  for (int i = 0; i < 2; ++i) {
    SrpHarness h(loadScene("point_light_cube"));
    h.set("srp.receiver_rays", "64").set("srp.sh_order", "0").set("srp.k", "8").set("srp.cluster_size", "1024").set("srp.precompute_memory_mb", i == 0 ? "2" : "512");
    h.set("lightmap.resolution", "48");
    results[i] = h.light();
    units[i] = h.technique->work().total;
  }
  EXPECT_GT(units[0], units[1]);
  EXPECT_EQ(results[0], results[1]);
  SrpHarness h(loadScene("point_light_cube"));
  h.set("srp.cluster_size", "8192").set("srp.least_clusters", "1").set("srp.k", "64").set("srp.sh_order", "8").set("srp.precompute_memory_mb", "16");
  try {
    h.rebuild();
    FAIL() << "a cluster that does not fit was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    EXPECT_NE(std::string(e.what()).find("srp.precompute_memory_mb is 16"), std::string::npos) << e.what();
  }
}

/// Many probes with many rays: what they see of surfaces is summed a few of them at a time, so that no unit takes long on a slow device, and any can be the last before a cancel.
TEST_F(SrpWork, SharesOfSurfacesGoInSlicesAndTheirTableIsCounted) {
  uint64_t bytes[2] = {};
  for (int on = 0; on < 2; ++on) {
    SrpHarness h(loadScene("point_light_cube"));
    h.set("lightmap.resolution", "32").set("srp.sh_order", "8").set("srp.receiver_rays", "16").set("srp.k", "1").set("srp.surface_share", on ? "true" : "false").set("probes.spacing", "0.15");
    h.rebuild();
    const double probes = h.counter("probes");
    double longest = 0;
    uint64_t slices = 0, asked = 0, total = h.technique->work().total;
    while (!h.technique->work().settled()) {
      const std::string label = h.technique->work().label;
      h.work(1);
      for (const PassTiming& pass : h.last.passes) {
        if (pass.name != "srp: share of surfaces" || !pass.skipped.empty()) continue;
        ++slices, longest = std::max(longest, pass.ms);
        EXPECT_NE(label.find("share of surfaces"), std::string::npos) << label;
        EXPECT_EQ(h.last.passes.size(), 1u) << "a unit of its own";
        for (const MemoryItem& m : h.technique->memory())
          if (m.name == "working memory of precomputation") bytes[on] = m.bytes;
      }
      if (h.technique->work().label.starts_with("transport") && asked++ == 0)
        for (const MemoryItem& m : h.technique->memory())
          if (m.name == "working memory of precomputation") bytes[on] = m.bytes;
      EXPECT_EQ(h.technique->work().total, total);
    }
    EXPECT_EQ(slices, on ? static_cast<uint64_t>(std::ceil(probes / std::floor((1 << 23) / (1024.0 * 81)))) : 0);
    if (on) {
      std::printf("%g probes, order 8, 1024 rays: share of surfaces in %llu slices, of %.1f ms at most\n", probes, static_cast<unsigned long long>(slices), longest);
      EXPECT_GT(slices, 2u);
      EXPECT_EQ(bytes[1] - bytes[0], static_cast<uint64_t>(4 * (probes * 81 - 1)));
    }
  }
}

TEST_F(SrpWork, ProbesTakeTurns) {
  SrpHarness all(loadScene("point_light_cube")), some(loadScene("point_light_cube"));
  for (SrpHarness* h : {&all, &some}) h->set("srp.receiver_rays", "64").set("lightmap.resolution", "32");
  some.set("srp.update_frames", "4");
  const std::vector<vec3> a = all.light(), b = some.light();
  EXPECT_NEAR(all.mean(a) / some.mean(b), 1, 2e-3);
}

}  // namespace
}  // namespace hl::test
