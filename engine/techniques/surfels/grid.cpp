#include "engine/techniques/surfels/grid.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace hl {
namespace {

/// What surfaces on the bounds' own faces need so as not to lie on the rim of a cell.
constexpr float kMargin = 1e-3f;

uvec3 sizeOf(const vec3& extent, float edge) {
  uvec3 size;
  for (int a = 0; a < 3; ++a) size[a] = static_cast<uint32_t>(std::clamp(std::ceil(extent[a] / edge), 1.0f, static_cast<float>(kMostCells)));
  return size;
}

}  // namespace

GridPlan planGrid(const Bounds& bounds, float edge) {
  GridPlan plan;
  const float margin = kMargin * edge;
  plan.origin = bounds.min - vec3(margin);
  const vec3 extent = bounds.max - bounds.min + vec3(2 * margin);
  plan.cellSize = edge;
  plan.size = sizeOf(extent, edge);
  while (static_cast<double>(plan.size.x) * plan.size.y * plan.size.z > kMostCells) {
    plan.cellSize *= 1.05f;
    plan.size = sizeOf(extent, plan.cellSize);
  }
  return plan;
}

SurfelGrid::SurfelGrid(Device& device, const GridPlan& plan, uint32_t maxSurfels) : plan_(plan) {
  const uint64_t bytes = uint64_t{maxSurfels} * kMostCellsOfSurfel * sizeof(uint32_t);
  if (bytes > device.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, "surfels: lists of cells for " + std::to_string(maxSurfels) + " surfels take " + std::to_string(bytes) +
                                       " bytes, a buffer of this device holds " + std::to_string(device.maxStorageBufferBytes()) + "; lower surfels.max_surfels");
  counts_ = device.buffer("surfels: cell counts", plan.cells() * sizeof(uint32_t));
  offsets_ = device.buffer("surfels: cell offsets", (plan.cells() + 1) * sizeof(uint32_t));
  entries_ = device.buffer("surfels: cell entries", bytes);
}

void SurfelGrid::recordEmpty(FrameGraph& graph) {
  graph.clear("surfels: clear cell counts", counts_);
  graph.clear("surfels: clear cell offsets", offsets_);
}

void SurfelGrid::record(FrameGraph& graph, const PrefixSum& prefix, const shared::SurfelFrame& frame, const SurfelsParams& params, const Buffer& sites,
                        const Buffer& states, const Buffer& records, const Buffer& totals, const Buffer& transforms) {
  graph.compute("surfels: count cells", "surfels/count_cells.comp")
      .bind("sites", sites, Access::Read)
      .bind("states", states, Access::Read)
      .bind("records", records, Access::ReadWrite)
      .bind("cellCounts", counts_, Access::ReadWrite)
      .bind("object_transforms", transforms, Access::Read)
      .uniform("frame", frame)
      .uniform("surfels", params)
      .dispatchThreads(frame.surfels);
  prefix.record(graph, "surfels: cell offsets", counts_, offsets_, plan_.cells());
  graph.compute("surfels: scatter", "surfels/scatter.comp")
      .bind("records", records, Access::Read)
      .bind("cellOffsets", offsets_, Access::Read)
      .bind("cellCounts", counts_, Access::ReadWrite)
      .bind("cellEntries", entries_, Access::Write)
      .uniform("frame", frame)
      .uniform("surfels", params)
      .dispatchThreads(frame.surfels);
  graph.compute("surfels: sort cells", "surfels/sort_cells.comp")
      .bind("cellOffsets", offsets_, Access::Read)
      .bind("cellEntries", entries_, Access::ReadWrite)
      .bind("totals", totals, Access::ReadWrite)
      .uniform("frame", frame)
      .uniform("surfels", params)
      .dispatchThreads(plan_.cells());
}

}  // namespace hl
