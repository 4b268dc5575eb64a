#pragma once
// The uniform grid that look-ups go by: which cells there are, and the passes that fill them.
#include "engine/gpu/frame_graph.h"
#include "engine/scene/scene.h"
#include "engine/techniques/surfels/params.h"
#include "engine/techniques/surfels/prefix_sum.h"
#include "engine/techniques/surfels/surfel.h"

namespace hl {

/// Cells over the scene's bounds. Their edge is at least the largest radius, so that a surfel reaches at most three along each axis.
struct GridPlan {
  vec3 origin{0.0f};
  float cellSize = 1;  ///< [m]
  uvec3 size{1, 1, 1};
  uint32_t cells() const { return size.x * size.y * size.z; }
};
inline constexpr uint32_t kMostCells = 1u << 18;
inline constexpr uint32_t kMostCellsOfSurfel = 27;
/// `edge` [m] is enlarged where it would make more than kMostCells.
GridPlan planGrid(const Bounds&, float edge);

class SurfelGrid {
 public:
  /// @throws Error(TooLarge) where a buffer of the device can't hold the lists
  SurfelGrid(Device&, const GridPlan&, uint32_t maxSurfels);

  const GridPlan& plan() const { return plan_; }
  /// Each surfel's place in the world, and the sorted lists of cells. Passes "surfels: count cells", "surfels: cell offsets: ...", "surfels: scatter",
  /// "surfels: sort cells".
  void record(FrameGraph&, const PrefixSum&, const shared::SurfelFrame&, const SurfelsParams&, const Buffer& sites, const Buffer& states, const Buffer& records,
              const Buffer& totals, const Buffer& transforms);
  /// Empty lists, before there is any surfel.
  void recordEmpty(FrameGraph&);
  const Buffer& offsets() const { return offsets_; }  ///< uint a cell and one more: where its list begins in entries()
  const Buffer& entries() const { return entries_; }  ///< uint: surfels, in rising order within a cell
  uint64_t bytes() const { return counts_.size() + offsets_.size() + entries_.size(); }

 private:
  GridPlan plan_;
  Buffer counts_, offsets_, entries_;
};

}  // namespace hl
