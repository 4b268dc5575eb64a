// The parts of the GPU layer that are plain bookkeeping: free ranges, hazards, statistics of times.
#include <gtest/gtest.h>

#include <random>

#include "engine/gpu/free_list.h"
#include "engine/gpu/hazards.h"
#include "engine/gpu/profiler.h"

namespace hl {
namespace {

TEST(FreeList, AlignsAndFillsGaps) {
  FreeList list(1000);
  EXPECT_EQ(list.allocate(10, 1), 0u);
  EXPECT_EQ(list.allocate(100, 256), 256u);
  // The gap before the aligned piece is still there.
  EXPECT_EQ(list.allocate(246, 2), 10u);
  EXPECT_EQ(list.allocate(645, 4), std::nullopt);
  EXPECT_EQ(list.allocate(644, 4), 356u);
  EXPECT_EQ(list.freeBytes(), 0u);
  EXPECT_EQ(list.allocate(1, 1), std::nullopt);
}

TEST(FreeList, NeighboursGrowTogether) {
  FreeList list(300);
  for (uint64_t i = 0; i < 3; ++i) EXPECT_EQ(list.allocate(100, 4), i * 100);
  list.release(0, 100);
  list.release(200, 100);
  EXPECT_EQ(list.ranges(), 2u);
  EXPECT_EQ(list.allocate(150, 1), std::nullopt);
  list.release(100, 100);
  EXPECT_EQ(list.ranges(), 1u);
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(list.allocate(300, 1), 0u);
}

TEST(FreeList, NeverHandsOutAByteTwice) {
  FreeList list(1 << 16);
  std::mt19937 random(7);
  struct Piece {
    uint64_t offset, bytes;
  };
  std::vector<Piece> held;
  std::vector<char> taken(1 << 16, 0);
  for (int step = 0; step < 20000; ++step) {
    if (!held.empty() && random() % 2 == 0) {
      const size_t i = random() % held.size();
      list.release(held[i].offset, held[i].bytes);
      std::fill_n(taken.begin() + static_cast<std::ptrdiff_t>(held[i].offset), held[i].bytes, char{0});
      held[i] = held.back();
      held.pop_back();
      continue;
    }
    const uint64_t bytes = 1 + random() % 3000, alignment = 1ull << (random() % 10);
    const auto offset = list.allocate(bytes, alignment);
    if (!offset) continue;
    ASSERT_EQ(*offset % alignment, 0u);
    ASSERT_LE(*offset + bytes, taken.size());
    for (uint64_t b = 0; b < bytes; ++b) {
      ASSERT_EQ(taken[*offset + b], 0);
      taken[*offset + b] = 1;
    }
    held.push_back({*offset, bytes});
  }
  ASSERT_EQ(list.freeBytes(), static_cast<uint64_t>(std::count(taken.begin(), taken.end(), 0)));
  for (const Piece& p : held) list.release(p.offset, p.bytes);
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(list.ranges(), 1u);
}

constexpr VkPipelineStageFlags2 kCompute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                kFragment = VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
constexpr VkAccessFlags2 kLoad = VK_ACCESS_2_SHADER_STORAGE_READ_BIT, kStore = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;

std::string hazardOf(ResourceHistory& h, const ResourceUse& use) {
  const Dependency d = nextUse(h, use);
  return d.hazard == nullptr ? "" : d.hazard;
}

TEST(Hazards, AreNamedAndWaitForWhatWasBefore) {
  ResourceHistory h;
  EXPECT_EQ(hazardOf(h, {kCompute, kLoad, 0}), "");
  EXPECT_EQ(hazardOf(h, {kCompute, 0, kStore}), "WAR");
  EXPECT_EQ(hazardOf(h, {kCompute, 0, kStore}), "WAW");
  EXPECT_EQ(hazardOf(h, {kCompute, kLoad, kStore}), "RAW");
  EXPECT_EQ(hazardOf(h, {kCompute, kLoad, 0}), "RAW");
  EXPECT_EQ(hazardOf(h, {kCompute, kLoad, 0}), "");  // already visible there
  const Dependency d = nextUse(h, {kFragment, kLoad, 0});
  EXPECT_STREQ(d.hazard, "RAW");  // but not in another stage
  EXPECT_EQ(d.sourceAccess, kStore);
  const Dependency w = nextUse(h, {kCompute, 0, kStore});
  EXPECT_STREQ(w.hazard, "WAR");
  EXPECT_EQ(w.sourceStages & (kCompute | kFragment), kCompute | kFragment);  // both readers
}

TEST(Hazards, ChangesOfLayoutWaitForReadersAndAreWaitedFor) {
  ResourceHistory h;
  EXPECT_EQ(hazardOf(h, {kCompute, 0, kStore, VK_IMAGE_LAYOUT_GENERAL}), "layout");
  EXPECT_EQ(hazardOf(h, {kFragment, kLoad, 0, VK_IMAGE_LAYOUT_GENERAL}), "RAW");
  const Dependency d = nextUse(h, {kCompute, kLoad, 0, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
  EXPECT_EQ(d.oldLayout, VK_IMAGE_LAYOUT_GENERAL);
  EXPECT_EQ(d.newLayout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  EXPECT_NE(d.sourceStages & kFragment, 0u);
  EXPECT_EQ(hazardOf(h, {kCompute, kLoad, 0, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL}), "");
  EXPECT_EQ(hazardOf(h, {kFragment, kLoad, 0, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL}), "RAW");
}

BatchTimings batch(double ms, double creation = 0) {
  BatchTimings b;
  b.passes.push_back({"trace", false, ms, creation, ""});
  b.passes.push_back({"sky", false, 0, 0, "no sky"});
  b.wallMs = ms + 1;
  return b;
}

TEST(Profiler, LeavesOutWarmUpAndKeepsAWindow) {
  Profiler profiler(10);
  profiler.add(batch(1000));
  profiler.add(batch(500, 3));  // a pipeline was made again
  for (int i = 1; i <= 30; ++i) profiler.add(batch(i));
  const std::vector<PassStatistics> passes = profiler.passes();
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_EQ(passes[0].where, "gpu");
  EXPECT_DOUBLE_EQ(passes[0].lastMs, 30);
  EXPECT_DOUBLE_EQ(passes[0].medianMs, 25.5);  // of 21 to 30
  EXPECT_DOUBLE_EQ(passes[0].p5Ms, 21.45);
  EXPECT_DOUBLE_EQ(passes[0].p95Ms, 29.55);
  EXPECT_DOUBLE_EQ(passes[0].meanMs, 25.5);
  EXPECT_DOUBLE_EQ(passes[0].share, 1);
  EXPECT_EQ(passes[1].skipped, "no sky");
  EXPECT_DOUBLE_EQ(profiler.frame().medianMs, 26.5);
  EXPECT_NEAR(profiler.unaccounted(), 0.5 * (1.0 / 26 + 1.0 / 27), 1e-12);
  EXPECT_EQ(profiler.frames(), 32u);
  profiler.clear();
  EXPECT_TRUE(profiler.passes().empty());
}

TEST(Profiler, KnowsInHowManyFramesAPassRan) {
  Profiler profiler(12);
  for (int i = 0; i < 40; ++i) {
    BatchTimings b = batch(i % 4 == 0 ? 8 : 2);
    if (i % 4 != 0) b.passes[0].skipped = "its turn is in another frame";
    if (i % 4 == 2) b.passes.insert(b.passes.begin() + 1, {"shade", false, 5, 0, ""});
    b.wallMs = i % 4 == 0 ? 9 : 1;
    profiler.add(b);
  }
  const PassStatistics trace = profiler.passes()[0];
  EXPECT_DOUBLE_EQ(trace.medianMs, 8);
  EXPECT_DOUBLE_EQ(trace.share, 0.25);
  ASSERT_EQ(profiler.passes().size(), 3u);  // though the last frame had two
  EXPECT_EQ(profiler.passes()[1].name, "shade");
  EXPECT_EQ(profiler.passes()[1].skipped, "not in the latest frame");
  EXPECT_DOUBLE_EQ(profiler.passes()[1].share, 0.25);
  EXPECT_DOUBLE_EQ(profiler.passes()[2].share, 0);
  EXPECT_DOUBLE_EQ(trace.frameMs, 2);
  EXPECT_DOUBLE_EQ(profiler.frame().medianMs, 1);
  EXPECT_DOUBLE_EQ(profiler.frame().meanMs, 3);
  BatchTimings none = batch(0);
  none.passes[0].skipped = "done";
  for (int i = 0; i < 13; ++i) profiler.add(none);
  EXPECT_DOUBLE_EQ(profiler.passes()[0].share, 0);  // of the latest
  EXPECT_EQ(profiler.passes().size(), 2u);
  profiler.forgetTimes();
  for (int i = 0; i < 4; ++i) profiler.add(batch(i == 0 ? 40 : 4));
  EXPECT_DOUBLE_EQ(profiler.passes()[0].frameMs, 13);  // the first counts: it is no warm-up
  EXPECT_DOUBLE_EQ(profiler.frame().meanMs, 14);
}

TEST(Profiler, AddsUpPassesOfOneName) {
  Profiler profiler;
  BatchTimings b;
  b.passes = {{"blur", false, 1, 0, ""}, {"cast", true, 5, 0, ""}, {"blur", false, 2, 0, ""}};
  profiler.add(b);
  profiler.add(b);
  const auto passes = profiler.passes();
  ASSERT_EQ(passes.size(), 2u);
  EXPECT_DOUBLE_EQ(passes[0].medianMs, 3);
  EXPECT_EQ(passes[1].where, "host");
}

}  // namespace
}  // namespace hl
