#pragma once
// The surfels of a scene: their memory, and a frame's passes over them.
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/passes/hit_surfaces.h"
#include "engine/techniques/surfels/grid.h"
#include "engine/techniques/surfels/params.h"
#include "engine/techniques/surfels/prefix_sum.h"
#include "engine/techniques/surfels/surfel.h"
#include "engine/techniques/technique.h"

namespace hl {

class SurfelCache {
 public:
  /// Allocates everything. @throws Error(TooLarge) naming what does not fit
  SurfelCache(Gpu&, const SceneView&, const SurfelsParams&);

  /// Forgets all surfels.
  void restart();
  /// One frame: sorts, casts, shades, updates; then irradiance at pixels into `result` (RGBA32F, alpha: coverage); then places and recycles.
  void record(FrameGraph&, const FrameInputs&, const SurfelsParams&, const GpuImage& result);
  /// A debug view of the last recorded frame; `what`: a number of show.comp.
  void recordView(FrameGraph&, const FrameInputs&, const SurfelsParams&, const GpuImage& irradiance, const GpuImage& target, uint32_t what);

  std::vector<MemoryItem> memory() const;
  std::vector<std::pair<std::string, double>> counters();
  PickReport pick(const PickedPoint&, const SurfelsParams&);

 private:
  struct Ray {
    Buffer rays, hits, samples, arrivals;
  };
  void harvest();
  /// Whether any surfel may stand elsewhere, or reach another list, than in the last frame.
  bool moved(const FrameInputs&, const shared::SurfelFrame&) const;
  /// Whether tiles or hits lack surfels in such numbers that the next frame should place more.
  bool lacksSurfels(const SurfelsParams&) const;
  void reserve(const shared::SurfelFrame&, bool splat);
  shared::SurfelFrame frameOf(const FrameInputs&, const SurfelsParams&) const;
  void recordClears(FrameGraph&, const shared::SurfelFrame&);
  void recordTileDepths(FrameGraph&, const shared::SurfelFrame&, const GBuffer&, bool splat);
  void recordRays(FrameGraph&, const shared::SurfelFrame&, const SurfelsParams&);
  void recordUpdate(FrameGraph&, const shared::SurfelFrame&, const SurfelsParams&);
  void recordGather(FrameGraph&, const shared::SurfelFrame&, const SurfelsParams&, const GBuffer&, const GpuImage& result);
  void recordPlace(FrameGraph&, const shared::SurfelFrame&, const SurfelsParams&, const GBuffer&, const GpuImage& result);
  void recordRecycle(FrameGraph&, const shared::SurfelFrame&, const SurfelsParams&);
  /// What look-ups read, for passes that include cache.glsl with HL_SURFELS_LOOKUP.
  ComputePass& bindLookup(ComputePass& pass, const shared::SurfelFrame&, const SurfelsParams&) const;

  Device& device_;
  SceneView scene_;
  uint32_t maxSurfels_ = 0;
  bool depthTest_ = false, guiding_ = false;
  std::unique_ptr<SurfelGrid> grid_;
  bool newLists_ = true;     ///< of cells and tiles: not empty yet
  std::unique_ptr<PrefixSum> prefix_;
  HitSurfaces hitSurfaces_;

  Buffer sites_, states_, records_, depth_, guide_;  ///< by surfel; the last two stand in by another where they are off
  Buffer totals_, freeIds_, claims_;
  Buffer shares_, shareSums_;                        ///< by surfel
  Buffer recycleFlags_, recycleOrder_;               ///< by surfel
  Buffer tileDepths_;                                ///< by tile of the screen, where surfels are drawn into these
  Buffer candidates_, placeFlags_, placeOrder_;      ///< by candidate
  Ray ray_;

  uint32_t frame_ = 0;       ///< recorded since the restart
  uint32_t lastPlaced_ = 0;  ///< frame
  bool listsStand_ = false;  ///< nothing was placed or removed since they were made
  float age_ = 0;            ///< SurfelFrame::age of the last one
  uint32_t still_ = 0;       ///< the next one's SurfelFrame::still, if nothing changes in it
  uint32_t casts_ = 0;       ///< frames so far that cast rays
  SurfelsParams lastParams_{};
  uint32_t harvested_ = 0;   ///< stamp of the last totals that were read
  shared::SurfelTotals last_{};
  shared::SurfelFrame lastFrame_{};
  std::array<double, shared::kSurfelCounters> sums_{};  ///< of counters since the restart
  double raysCast_ = 0;
};

}  // namespace hl
