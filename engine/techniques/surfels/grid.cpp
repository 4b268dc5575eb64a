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

namespace {

/// Least share of its distance that a cell's edge is: finer ones would only be empty.
constexpr float kLeastEdge = 0.02f;
constexpr float kMostEdge = 4;
/// A cell's edge in radii of the surfels there: one in view reaches two along each axis, one that reaches twice as far two or three. Smaller cells make shorter lists
/// but more entries, which every frame of a flight has to sort.
constexpr float kEdgeInRadii = 3;

CameraGridPlan planWithShape(const Bounds& bounds, vec3 eye, const shared::GridShape& shape) {
  CameraGridPlan plan;
  plan.shape = shape;
  const vec3 centre = 0.5f * (bounds.min + bounds.max) - eye, half = 0.5f * (bounds.max - bounds.min);
  double cells = 0;
  for (uint32_t r = 0; r < shared::kGridRegions; ++r) {
    shared::GridRegion& region = plan.regions[r];
    region.firstCell = static_cast<uint32_t>(std::min<double>(cells, kMostCells));
    region.size = uvec3(1);
    vec3 low, high;
    if (shared::gridReach(centre, half, r, shape, low, high)) {
      if (r == 0) low = glm::max(low, vec3(-1 / shape.edge)), high = glm::min(high, vec3(1 / shape.edge));
      region.low = glm::floor(low);
      region.size = uvec3(glm::clamp(glm::floor(high) - region.low + 1.0f, vec3(1), vec3(static_cast<float>(kMostCells))));
    }
    cells += static_cast<double>(region.size.x) * region.size.y * region.size.z;
  }
  plan.cells = static_cast<uint32_t>(std::min<double>(cells, 4.0 * kMostCells));
  return plan;
}

}  // namespace

CameraGridPlan planCameraGrid(const Bounds& sceneBounds, vec3 eye, float least, float perDistance, float most) {
  Bounds bounds = sceneBounds;
  if (bounds.empty()) bounds.extend(eye);
  if (!(most > 0)) least = most = 1;  // a scene without extent: any cells will do
  for (float larger = 1;; larger *= 1.1f) {
    shared::GridShape shape{};
    shape.edge = std::min(larger * std::clamp(kEdgeInRadii * perDistance, kLeastEdge, 1.0f), kMostEdge);
    shape.perLog = 1 / std::log1p(shape.edge);
    // Where the least radius takes over from the one that follows the distance, or where it would fill a cell.
    shape.inner = std::max(perDistance > 0 ? least / perDistance : 0.0f, kEdgeInRadii * least / shape.edge);
    shape.outer = std::max(shape.inner, perDistance > 0 ? most / perDistance : 0.0f);
    shape.outerEdge = larger * most;
    const CameraGridPlan plan = planWithShape(bounds, eye, shape);
    if (plan.cells <= kMostCells) return plan;
  }
}

uint32_t entriesASurfel(float hitReach) {
  const float more = std::max(1.0f, hitReach / 2);
  return static_cast<uint32_t>(std::ceil(static_cast<float>(kMostCellsOfSurfel) * more * more));  // discs: by the square
}

SurfelGrid::SurfelGrid(Device& device, const GridPlan& plan, uint32_t maxSurfels, bool camera, float hitReach)
    : device_(device), plan_(plan), camera_(camera), sorting_(device.isCpu() ? kSortingOnCpu : kSortingOnGpu), room_(maxSurfels * entriesASurfel(hitReach)) {
  const uint64_t bytes = uint64_t{maxSurfels} * entriesASurfel(hitReach) * sizeof(uint32_t);
  if (bytes > device.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, "surfels: lists of cells for " + std::to_string(maxSurfels) + " surfels take " + std::to_string(bytes) +
                                       " bytes, a buffer of this device holds " + std::to_string(device.maxStorageBufferBytes()) + "; lower surfels.max_surfels or surfels.hit_reach");
  reserve(0);
  entries_ = device.buffer("surfels: cell entries", bytes);
  noTiles_ = device.buffer("surfels: no tiles", sizeof(vec2));
}

bool SurfelGrid::reserve(uint32_t tiles) {
  const uint64_t lists = uint64_t{camera_ ? kMostCells : plan_.cells()} + tiles;
  if (counts_ && counts_.size() >= lists * sizeof(uint32_t)) return false;
  counts_ = device_.buffer("surfels: cell counts", lists * sizeof(uint32_t));
  offsets_ = device_.buffer("surfels: cell offsets", (lists + 1) * sizeof(uint32_t));
  return true;
}

void SurfelGrid::recordEmpty(FrameGraph& graph) {
  graph.clear("surfels: clear cell counts", counts_);
  graph.clear("surfels: clear cell offsets", offsets_);
}

void SurfelGrid::record(FrameGraph& graph, const PrefixSum& prefix, const shared::SurfelFrame& frame, const SurfelsParams& params, const Buffer& sites,
                        const Buffer& states, const Buffer& records, const Buffer& totals, const Buffer& transforms, const Buffer& tileDepths) {
  graph.compute("surfels: count cells", "surfels/count_cells.comp")
      .bind("sites", sites, Access::Read)
      .bind("states", states, Access::Read)
      .bind("records", records, Access::ReadWrite)
      .bind("cellCounts", counts_, Access::ReadWrite)
      .bind("object_transforms", transforms, Access::Read)
      .bind("tileDepths", tileDepths ? tileDepths : noTiles_, Access::Read)
      .specialize("kCameraGrid", camera_ ? 1 : 0)
      .specialize("kSplat", tileDepths ? 1 : 0)
      .uniform("frame", frame)
      .uniform("surfels", params)
      .dispatchThreads(frame.surfels);
  prefix.record(graph, "surfels: cell offsets", counts_, offsets_, frame.lists);
  graph.compute("surfels: scatter", "surfels/scatter.comp")
      .bind("records", records, Access::Read)
      .bind("cellOffsets", offsets_, Access::Read)
      .bind("cellCounts", counts_, Access::ReadWrite)
      .bind("cellEntries", entries_, Access::Write)
      .bind("tileDepths", tileDepths ? tileDepths : noTiles_, Access::Read)
      .specialize("kCameraGrid", camera_ ? 1 : 0)
      .specialize("kSplat", tileDepths ? 1 : 0)
      .uniform("frame", frame)
      .uniform("surfels", params)
      .dispatchThreads(frame.surfels);
  graph.compute("surfels: sort cells", "surfels/sort_cells.comp")
      .bind("cellOffsets", offsets_, Access::Read)
      .bind("cellEntries", entries_, Access::ReadWrite)
      .bind("totals", totals, Access::ReadWrite)
      .specialize("kListsOfGroup", sorting_.listsOfGroup)
      .specialize("kAlone", sorting_.alone)
      .specialize("kRanked", sorting_.ranked)
      .uniform("frame", frame)
      .uniform("surfels", params)
      .dispatch((frame.lists + sorting_.listsOfGroup - 1) / sorting_.listsOfGroup);
}

}  // namespace hl
