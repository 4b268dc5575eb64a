#pragma once
// The grids that look-ups go by: which cells there are, and the passes that fill their lists, and those of the screen's tiles.
#include <array>

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
/// Room that lists have for each surfel on average, where hidden ones reach so many radii: three radii to a cell, so up to two fit into as many cells as one does.
uint32_t entriesASurfel(float hitReach);
/// The camera's grid of one frame (grid_cells.h).
struct CameraGridPlan {
  shared::GridShape shape{1, 1, 1, 1, 1};
  std::array<shared::GridRegion, shared::kGridRegions> regions{};
  uint32_t cells = 0;
};
/// Cells of three times a surfel's radius, where that is `perDistance` times the distance from the eye but at least `least` and at most `most` [m]; of once that, as in
/// the uniform grid, from where it is `most`. They are enlarged where there would be more than kMostCells.
CameraGridPlan planCameraGrid(const Bounds&, vec3 eye, float least, float perDistance, float most);

/// `edge` [m] is enlarged where it would make more than kMostCells.
GridPlan planGrid(const Bounds&, float edge);

/// How the lists are sorted: specialisation of sort_cells.comp. The result is the same.
struct SurfelSorting {
  uint32_t listsOfGroup;  ///< lists a work group, at most 128
  uint32_t alone;         ///< entries up to which one invocation sorts a list
  uint32_t ranked;        ///< beyond `alone`: entries up to which each finds its own place
};
/// Full cells lie together, so a group gets few; most are empty, so not one.
inline constexpr SurfelSorting kSortingOnGpu{8, 0, 512};
/// Invocations run a few at a time and nearly in their order, which leaves lists nearly sorted; barriers cost much. lavapipe ends an invocation's loops after 65535 rounds in
/// all, with what has been done by then: a list of this length takes less in any order.
inline constexpr SurfelSorting kSortingOnCpu{128, 512, 0};

class SurfelGrid {
 public:
  /// @throws Error(TooLarge) where a buffer of the device can't hold the lists
  SurfelGrid(Device&, const GridPlan&, uint32_t maxSurfels, bool camera = false, float hitReach = 1);

  const GridPlan& plan() const { return plan_; }
  bool camera() const { return camera_; }
  uint32_t room() const { return room_; }  ///< for surfels in all lists
  /// Lists for the cells and so many tiles of the screen. True: they are new, and need recordEmpty.
  bool reserve(uint32_t tiles);
  /// Each surfel's place in the world, and the sorted lists of cells and, where `tileDepths` is given, tiles. Passes "surfels: count cells", "surfels: cell offsets: ...", "surfels: scatter",
  /// "surfels: sort cells".
  void record(FrameGraph&, const PrefixSum&, const shared::SurfelFrame&, const SurfelsParams&, const Buffer& sites, const Buffer& states, const Buffer& records,
              const Buffer& totals, const Buffer& transforms, const Buffer& tileDepths = {});
  /// Empty lists, before there is any surfel.
  void recordEmpty(FrameGraph&);
  const Buffer& offsets() const { return offsets_; }  ///< uint a cell and one more: where its list begins in entries()
  const Buffer& entries() const { return entries_; }  ///< uint: surfels, in rising order within a cell
  uint64_t bytes() const { return counts_.size() + offsets_.size() + entries_.size(); }

 private:
  Device& device_;
  GridPlan plan_;
  bool camera_ = false;
  SurfelSorting sorting_;
  uint32_t room_ = 0;
  Buffer counts_, offsets_, entries_;
  Buffer noTiles_;  ///< bound in place of depths of tiles that there are none of
};

}  // namespace hl
