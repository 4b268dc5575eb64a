// Prefix sums and the surfel grid against the host.
#include <algorithm>
#include <random>
#include <set>
#include <utility>

#include "engine/techniques/surfels/grid.h"
#include "shaders/shared/scene_types.h"
#include "tests/gpu_fixture.h"

namespace hl::test {
namespace {

class SurfelsGrid : public GpuTest {};

TEST_F(SurfelsGrid, PrefixSumsAreTheHosts) {
  std::mt19937 random(7);
  for (const uint32_t count : {1u, 2u, 255u, 1023u, 1024u, 1025u, 5000u, 300000u}) {
    std::vector<uint32_t> values(count);
    for (uint32_t& v : values) v = static_cast<uint32_t>(random() % 1000);
    const PrefixSum prefix(*device, count);
    const Buffer in = device->buffer("values", std::span<const uint32_t>(values));
    const Buffer out = device->buffer("sums", (count + 1) * sizeof(uint32_t));
    prefix.record(*graph, "sum", in, out, count);
    graph->execute();
    const std::vector<uint32_t> sums = download<uint32_t>(out);
    uint32_t running = 0;
    for (uint32_t i = 0; i < count; ++i) {
      ASSERT_EQ(sums[i], running) << "of " << count << " at " << i;
      running += values[i];
    }
    ASSERT_EQ(sums[count], running) << count;
  }
}

TEST_F(SurfelsGrid, TooManyValuesAreRefused) {
  const PrefixSum prefix(*device, 100);
  const Buffer in = device->buffer("values", 400), out = device->buffer("sums", 404);
  EXPECT_THROW(prefix.record(*graph, "sum", in, out, 101), Error);
  EXPECT_THROW(PrefixSum(*device, PrefixSum::kMost + 1), Error);
}

TEST_F(SurfelsGrid, PlanCoversTheBoundsWithinItsLimit) {
  Bounds bounds;
  bounds.extend(vec3(-1, 0, 2));
  bounds.extend(vec3(3, 0.5f, 4));
  for (const float edge : {2.0f, 0.1f, 1e-3f}) {
    const GridPlan plan = planGrid(bounds, edge);
    EXPECT_LE(plan.cells(), kMostCells);
    EXPECT_GE(plan.cellSize, edge);
    for (int a = 0; a < 3; ++a) {
      EXPECT_LE(plan.origin[a], bounds.min[a]);
      EXPECT_GE(plan.origin[a] + plan.cellSize * static_cast<float>(plan.size[a]), bounds.max[a]);
    }
  }
}

/// Every point that a surfel lights lies in a cell that lists it, once, in rising order; the same list in every run, also where a single cell holds all.
TEST_F(SurfelsGrid, ListsHoldEverySurfelThatReachesTheCell) {
  constexpr uint32_t kCount = 5000, kMost = 8192;
  Bounds bounds;
  bounds.extend(vec3(0));
  bounds.extend(vec3(1, 2, 1));
  SurfelsParams params;
  params.sizing = kSizingWorld;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<shared::Surfel> sites(kCount);
  std::vector<shared::SurfelState> states(kCount);
  for (uint32_t i = 0; i < kCount; ++i) {
    sites[i] = {vec3(unit(random), 2 * unit(random), unit(random)), 0, glm::normalize(vec3(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f)), 0};
    states[i] = {};
    states[i].priority = i % 10 == 3 ? 0 : 1;  // some numbers are free
  }
  const shared::ObjectTransform still{mat4(1.0f), mat4(1.0f), mat4(1.0f), 0, 0};
  const Buffer transforms = device->buffer("transforms", sizeof still);
  device->upload(transforms, &still, sizeof still);
  for (const float edge : {0.11f, 3.0f}) {
    const GridPlan plan = planGrid(bounds, edge);
    shared::SurfelFrame frame{};
    frame.gridOrigin = plan.origin, frame.cellSize = plan.cellSize, frame.gridSize = plan.size, frame.cells = frame.lists = plan.cells(), frame.entriesMost = kMost * kMostCellsOfSurfel;
    frame.radius = 0.1f, frame.surfels = kCount;
    std::vector<uint32_t> first;
    for (int run = 0; run < 2; ++run) {
      SurfelGrid grid(*device, plan, kMost);
      const PrefixSum prefix(*device, plan.cells());
      const Buffer site = device->buffer("sites", std::span<const shared::Surfel>(sites));
      const Buffer state = device->buffer("states", std::span<const shared::SurfelState>(states));
      const Buffer records = device->buffer("records", kCount * shared::kRecordTexels * sizeof(vec4));
      const Buffer totals = device->buffer("totals", sizeof(shared::SurfelTotals));
      graph->clear("clear totals", totals);
      graph->clear("clear records", records);
      grid.recordEmpty(*graph);
      for (int frames = 0; frames < 2; ++frames) grid.record(*graph, prefix, frame, params, site, state, records, totals, transforms);
      graph->execute();
      const std::vector<uint32_t> offsets = download<uint32_t>(grid.offsets());
      std::vector<uint32_t> entries = download<uint32_t>(grid.entries());
      entries.resize(offsets.back());
      ASSERT_LE(offsets.back(), kCount * kMostCellsOfSurfel);
      for (uint32_t c = 0; c < plan.cells(); ++c)
        for (uint32_t e = offsets[c]; e + 1 < offsets[c + 1]; ++e) ASSERT_LT(entries[e], entries[e + 1]) << "cell " << c;
      for (int i = 0; i < 10000; ++i) {
        const auto id = static_cast<uint32_t>(random() % kCount);
        const vec3 to = frame.radius * vec3(2 * unit(random) - 1, 2 * unit(random) - 1, 2 * unit(random) - 1);
        const vec3 p = sites[id].position + to;
        if (glm::any(glm::lessThan(p, bounds.min)) || glm::any(glm::greaterThan(p, bounds.max))) continue;
        if (shared::surfelDistance2(to, sites[id].normal, frame.radius, params.normal_squash) >= 1) continue;
        const uvec3 c((p - plan.origin) / plan.cellSize);
        const uint32_t cell = (c.z * plan.size.y + c.y) * plan.size.x + c.x;
        const bool listed = std::binary_search(entries.begin() + offsets[cell], entries.begin() + offsets[cell + 1], id);
        ASSERT_EQ(listed, states[id].priority != 0) << "surfel " << id;
      }
      if (run == 0) first = entries;
      EXPECT_EQ(entries, first);
    }
  }
}

/// Lists of all lengths, shuffled: in shared memory, and beyond what it holds. Those without room stay as they are, and are counted.
TEST_F(SurfelsGrid, ShuffledListsAreSortedHoweverWorkIsShared) {
  std::mt19937 random(11);
  std::vector<uint32_t> offsets{0}, entries;
  for (const uint32_t count : {0u, 1u, 2u, 3u, 5u, 31u, 32u, 33u, 127u, 128u, 129u, 1000u, 0u, 2047u, 2048u, 2049u, 5000u, 4u, 9u, 700u}) {
    for (uint32_t i = 0; i < count; ++i) entries.push_back(static_cast<uint32_t>(random()));
    offsets.push_back(static_cast<uint32_t>(entries.size()));
  }
  const auto lists = static_cast<uint32_t>(offsets.size() - 1);
  shared::SurfelFrame frame{};
  frame.cells = lists - 1, frame.lists = lists, frame.entriesMost = offsets[lists - 1];  // the last has no room
  SurfelsParams params;
  params.cell_limit = 2048;
  std::vector<uint32_t> expected = entries;
  for (uint32_t l = 0; l + 1 < lists; ++l) std::sort(expected.begin() + offsets[l], expected.begin() + offsets[l + 1]);
  for (const SurfelSorting& how : {kSortingOnCpu, kSortingOnGpu, SurfelSorting{1, 0, 0}, SurfelSorting{16, 4, 512}}) {
    const Buffer offset = device->buffer("offsets", std::span<const uint32_t>(offsets)), entry = device->buffer("entries", std::span<const uint32_t>(entries));
    const Buffer totals = device->buffer("totals", sizeof(shared::SurfelTotals));
    graph->clear("clear totals", totals);
    graph->compute("sort", "surfels/sort_cells.comp").bind("cellOffsets", offset, Access::Read).bind("cellEntries", entry, Access::ReadWrite).bind("totals", totals, Access::ReadWrite)
        .uniform("frame", frame).uniform("surfels", params).specialize("kListsOfGroup", how.listsOfGroup).specialize("kAlone", how.alone).specialize("kRanked", how.ranked).dispatch((lists + how.listsOfGroup - 1) / how.listsOfGroup);
    graph->execute();
    const std::vector<uint32_t> sorted = download<uint32_t>(entry);
    for (uint32_t l = 0; l < lists; ++l)
      EXPECT_TRUE(std::equal(sorted.begin() + offsets[l], sorted.begin() + offsets[l + 1], expected.begin() + offsets[l])) << how.listsOfGroup << ": list " << l << " of " << offsets[l + 1] - offsets[l];
    const auto t = download<shared::SurfelTotals>(totals).front();
    EXPECT_EQ(t.entries, entries.size()) << how.listsOfGroup;
    EXPECT_EQ(t.largestCell, 5000u) << how.listsOfGroup;
    EXPECT_EQ(t.counters[shared::kCountCellOverflows], 2u) << how.listsOfGroup;  // 2049 and 5000
    EXPECT_EQ(t.counters[shared::kCountDroppedLists], 1u) << how.listsOfGroup;
  }
}

/// The camera's grid against the host's own search: every point that a surfel lights lies in a cell that lists it, whichever region either is in.
TEST_F(SurfelsGrid, TheCamerasListsHoldEverySurfelThatReachesTheCell) {
  constexpr uint32_t kCount = 1500;
  Bounds bounds;
  bounds.extend(vec3(-3, -1, -2));
  bounds.extend(vec3(4, 2, 3));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto inBounds = [&] { return bounds.min + (bounds.max - bounds.min) * vec3(unit(random), unit(random), unit(random)); };
  SurfelsParams params;
  params.grid = kGridCamera, params.radius_pixels = 8;
  const Buffer transforms = device->buffer("transforms", sizeof(shared::ObjectTransform));
  const shared::ObjectTransform still{mat4(1.0f), mat4(1.0f), mat4(1.0f), 0, 0};
  device->upload(transforms, &still, sizeof still);
  // The smaller largest radius is reached within the bounds, so that cells beyond the frusta are met too.
  for (const auto& [eye, largest] : {std::pair{vec3(0.1f, 0.2f, 0), 0.4f}, {vec3(-2.9f, -0.9f, 2.9f), 0.15f}, {vec3(0, 0.5f, -9), 0.4f}, {vec3(0, 0.5f, -9), 0.05f}}) {
    shared::SurfelFrame frame{};
    frame.eye = eye, frame.radiusMax = largest, frame.pixelAngle = 0.008f, frame.surfels = kCount, frame.diagonal = 9;
    const CameraGridPlan plan = planCameraGrid(bounds, eye, params.hit_reach * shared::kLeastRadius * frame.radiusMax, params.hit_reach * params.radius_pixels * frame.pixelAngle, frame.radiusMax);
    EXPECT_LE(plan.cells, kMostCells);
    frame.grid = plan.shape;
    std::copy(plan.regions.begin(), plan.regions.end(), frame.regions);
    frame.cells = frame.lists = plan.cells;
    SurfelGrid grid(*device, planGrid(bounds, frame.radiusMax), 2048, true);
    frame.entriesMost = grid.room();
    std::vector<shared::Surfel> sites(kCount);
    std::vector<shared::SurfelState> states(kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
      // A third of them near the eye, where the cube is and all regions meet.
      const vec3 place = i % 3 == 0 ? eye + 4 * plan.shape.inner * (2.0f * vec3(unit(random), unit(random), unit(random)) - 1.0f) : inBounds();
      sites[i] = {place, 0, glm::normalize(vec3(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f)), 0};
      states[i] = {};
      states[i].priority = 1;
    }
    const PrefixSum prefix(*device, kMostCells);
    const Buffer site = device->buffer("sites", std::span<const shared::Surfel>(sites)), state = device->buffer("states", std::span<const shared::SurfelState>(states));
    const Buffer records = device->buffer("records", kCount * shared::kRecordTexels * sizeof(vec4)), totals = device->buffer("totals", sizeof(shared::SurfelTotals));
    graph->clear("clear totals", totals);
    graph->clear("clear records", records);
    grid.recordEmpty(*graph);
    grid.record(*graph, prefix, frame, params, site, state, records, totals, transforms);
    graph->execute();
    const std::vector<uint32_t> offsets = download<uint32_t>(grid.offsets()), entries = download<uint32_t>(grid.entries());
    ASSERT_LE(offsets[plan.cells], grid.room());
    EXPECT_LE(offsets[plan.cells], 18 * kCount);  // cells fit the surfels that they list
    int tried = 0;
    std::set<uint32_t> regions;
    for (int i = 0; i < 40000; ++i) {
      const auto id = static_cast<uint32_t>(random() % kCount);
      const float away = glm::length(sites[id].position - eye);
      const float radius = std::clamp(params.radius_pixels * frame.pixelAngle * away, shared::kLeastRadius * frame.radiusMax, frame.radiusMax);
      const vec3 to = 0.999f * radius * vec3(2 * unit(random) - 1, 2 * unit(random) - 1, 2 * unit(random) - 1);
      if (shared::surfelDistance2(to, sites[id].normal, radius, params.normal_squash) >= 1) continue;
      const vec3 q = sites[id].position + to - eye;
      const uint32_t which = shared::gridRegionOf(q, plan.shape);
      const shared::GridRegion& r = plan.regions[which];
      const ivec3 c = glm::clamp(ivec3(glm::floor(shared::gridCoordinates(q, which, plan.shape) - r.low)), ivec3(0), ivec3(r.size) - 1);
      const uint32_t cell = r.firstCell + (static_cast<uint32_t>(c.z) * r.size.y + static_cast<uint32_t>(c.y)) * r.size.x + static_cast<uint32_t>(c.x);
      ASSERT_TRUE(std::binary_search(entries.begin() + offsets[cell], entries.begin() + offsets[cell + 1], id)) << "surfel " << id << ", region " << which;
      ++tried;
      regions.insert(which);
    }
    EXPECT_GT(tried, 1000);
    EXPECT_GT(regions.size(), 1u);
  }
}

}  // namespace
}  // namespace hl::test
