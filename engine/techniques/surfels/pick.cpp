// What the cache holds, for reports: memory, counters, and the surfels that light a point somebody picked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/techniques/surfels/cache.h"

namespace hl {

std::vector<MemoryItem> SurfelCache::memory() const {
  std::vector<MemoryItem> items;
  const auto add = [&](const char* name, std::initializer_list<Buffer> buffers) {
    uint64_t bytes = 0;
    for (const Buffer& b : buffers) bytes += b ? b.size() : 0;
    items.push_back({name, bytes});
  };
  add("surfels", {sites_, states_, records_});
  add("maps of distances", {depth_});
  add("guides", {guide_});
  items.push_back({"grid", grid_->bytes() + claims_.size()});
  add("rays", {ray_.rays, ray_.hits, ray_.samples, ray_.arrivals});
  add("placing and recycling", {freeIds_, candidates_, placeFlags_, placeOrder_, recycleFlags_, recycleOrder_});
  items.push_back({"allotment and sums", shares_.size() + shareSums_.size() + prefix_->bytes() + totals_.size()});
  for (const auto& [name, bytes] : hitSurfaces_.memory()) items.push_back({name, bytes});
  return items;
}

std::vector<std::pair<std::string, double>> SurfelCache::counters() {
  harvest();
  const auto sum = [&](uint32_t which) { return sums_[which]; };
  std::vector<std::pair<std::string, double>> list = {
      {"surfels", last_.alive},
      {"surfels_high_water", last_.highWater},
      {"surfel_rays", raysCast_},
      {"surfel_hits", sum(shared::kCountHits)},
      {"uncovered_hits", sum(shared::kCountUncoveredHits)},
      {"uncovered_hits_last_frame", last_.counters[shared::kCountUncoveredHits]},
      {"unlit_hits", sum(shared::kCountUnlitHits)},
      {"black_hits", sum(shared::kCountBlackHits)},
      {"uncovered_pixels", last_.counters[shared::kCountUncoveredPixels]},
      {"unlit_pixels", last_.counters[shared::kCountUnlitPixels]},
      {"placed_at_pixels", sum(shared::kCountPlacedPixels)},
      {"placed_at_hits", sum(shared::kCountPlacedHits)},
      {"recycled", sum(shared::kCountRecycled)},
      {"max_surfels_reached", sum(shared::kCountMaxReached)},
      {"cell_entries", last_.entries},
      {"largest_cell", last_.largestCell},
      {"largest_tile", last_.largestTile},
      {"surfels_in_view", last_.inView},
      {"dropped_lists", sum(shared::kCountDroppedLists)},
      {"cell_overflows", last_.counters[shared::kCountCellOverflows]},
      {"upsample_misses", last_.counters[shared::kCountUpsampleMisses]},
      {"fireflies_cut", sum(shared::kCountFireflies)},
      {"surfel_nan", sum(shared::kCountNan)},
      {"surfel_inf", sum(shared::kCountInf)},
  };
  for (const auto& c : hitSurfaces_.counters()) list.push_back(c);
  return list;
}

PickReport SurfelCache::pick(const PickedPoint& point, const SurfelsParams& params) {
  harvest();
  PickReport report;
  if (point.triangle == kNone || frame_ == 0 || last_.entries == 0) return report;
  const GridPlan& plan = grid_->plan();
  const shared::SurfelFrame& f = lastFrame_;
  vec3 coordinates = (point.position - plan.origin) / plan.cellSize;
  shared::GridRegion region{vec3(0.0f), 0, plan.size};
  if (grid_->camera()) {
    const vec3 q = point.position - f.eye;
    const uint32_t which = shared::gridRegionOf(q, f.grid);
    region = f.regions[which];
    coordinates = shared::gridCoordinates(q, which, f.grid) - region.low;
  }
  const uvec3 cell(glm::clamp(ivec3(glm::floor(coordinates)), ivec3(0), ivec3(region.size) - 1));
  const uint32_t index = region.firstCell + (cell.z * region.size.y + cell.y) * region.size.x + cell.x;
  uint32_t range[2] = {0, 0};
  device_.download(grid_->offsets(), range, sizeof range, index * sizeof(uint32_t));
  const uint32_t held = range[1] - range[0], read = std::min(held, static_cast<uint32_t>(params.cell_limit));
  std::vector<uint32_t> ids(read);
  if (read > 0) device_.download(grid_->entries(), ids.data(), read * sizeof(uint32_t), range[0] * sizeof(uint32_t));
  report.facts = {{"cell", fmt::format("({}, {}, {})", cell.x, cell.y, cell.z)}, {"surfels in the cell", fmt::format("{}", held)}};
  double total = 0, coverage = 0;
  vec3 sum(0.0f);
  for (const uint32_t id : ids) {
    vec4 record[shared::kRecordTexels];
    device_.download(records_, record, sizeof record, id * sizeof record);
    const vec3 place(record[0]), normal(record[1]), light(record[2]);
    const float radius = std::abs(record[0].w);
    if (!(radius > 0)) continue;
    const vec3 to = point.position - place;
    const float falloff = shared::surfelFalloff(shared::surfelDistance2(to, normal, radius, params.normal_squash));
    const float facing = std::max(0.0f, glm::dot(point.normal, normal));
    if (!(falloff * facing > 0)) continue;
    float visible = 1;
    if (depthTest_) {
      constexpr uint32_t kTexels = shared::kDepthSide * shared::kDepthSide;
      vec2 moments;
      device_.download(depth_, &moments, sizeof moments, (id * kTexels + shared::depthTexel(to, normal)) * sizeof moments);
      visible = shared::depthVisibility(moments, shared::depthAcross(to, normal) / radius, params.depth_softness);
    }
    const float weight = falloff * facing * visible * record[1].w;
    coverage += static_cast<double>(falloff * facing * visible);
    total += static_cast<double>(weight);
    sum += weight * light;
    report.facts.push_back({fmt::format("surfel {}", id), fmt::format("falloff {:.3f} x facing {:.3f} x visible {:.3f} x confidence {:.3f} = {:.4f}; irradiance {:.4g}, {:.4g}, {:.4g}",
                                                                      falloff, facing, visible, record[1].w, weight, light.x, light.y, light.z)});
    PickSample s;
    s.from = place, s.to = point.position;
    s.radiance = light;
    s.weight = weight;
    report.samples.push_back(s);
  }
  if (total > 0) sum /= static_cast<float>(total);
  report.facts.insert(report.facts.begin() + 2, {{"coverage", fmt::format("{:.4f}", coverage)},
                                                 {"sum of weights", fmt::format("{:.4f}", total)},
                                                 {"irradiance", fmt::format("{:.4g}, {:.4g}, {:.4g}", sum.x, sum.y, sum.z)}});
  return report;
}

}  // namespace hl
