#pragma once
// The probes: where they stand, what they know of light and distances, and a frame of their rays.
#include <vector>

#include "engine/passes/hit_surfaces.h"
#include "engine/techniques/ddgi/grid.h"
#include "engine/techniques/ddgi/params.h"
#include "engine/techniques/technique.h"

namespace hl {

class DdgiProbes {
 public:
  /// @throws Error(TooLarge) as fitLattice
  DdgiProbes(Gpu&, const SceneView&, const DdgiParams&);

  /// Histories start anew; where probes stand is kept.
  void restart(const DdgiParams&);
  /// Probes are placed anew in the next frame; histories are kept.
  void geometryChanged() { placingWanted_ = true; }

  /// One frame: places probes where that is due, casts and shades rays (with what probes knew the frame before), blends. `frame` since the restart.
  void record(FrameGraph&, uint32_t frame, uint32_t seed);
  /// Irradiance at the G-buffer's pixels, by the probes as they are now, into `result`. Pass "ddgi: gather".
  void recordGather(FrameGraph&, const GBuffer&, vec3 viewer, const GpuImage& result);
  /// What engine/techniques/ddgi/lookup.glsl binds.
  void bindLookup(ComputePass&) const;

  const shared::DdgiGrid& grid() const { return grid_; }
  uint32_t count() const { return count_; }
  float albedo() const { return albedo_; }
  const GpuImage& irradianceAtlas() const { return irradiance_[current_]; }
  const GpuImage& distanceAtlas() const { return distance_[current_]; }
  std::vector<MemoryItem> memory() const;
  std::vector<std::pair<std::string, double>> counters() const;
  /// The eight probes round a point, with each factor of their weight. Blocking.
  PickReport pick(const PickedPoint&, vec3 viewer);

 private:
  void recordClears(FrameGraph&);
  void recordPlacing(FrameGraph&);
  void recordFixedRays(FrameGraph&, const shared::DdgiBatch&);
  void recordLight(FrameGraph&, shared::DdgiBatch, uint32_t batchNumber);
  void recordBlend(FrameGraph&, const shared::DdgiBatch&, bool distance);

  Device& device_;
  ShaderLibrary& shaders_;
  SceneView scene_;
  DdgiParams params_;
  shared::DdgiGrid grid_;
  uint32_t count_ = 0;
  float albedo_ = 0;
  HitSurfaces hitSurfaces_;
  Buffer probes_, ages_, needed_, rays_, hits_, radiance_, counters_;
  GpuImage irradiance_[2], distance_[2];  ///< what was known before a frame, and after it, by turns
  int current_ = 0;
  bool clearWanted_ = true, placingWanted_ = true;
  bool counted_ = false;                  ///< counters_ holds those of a frame
  struct Placed {
    uint32_t inside = 0, unneeded = 0, relocated = 0;
  };
  mutable Placed placed_;
  mutable bool placedStale_ = true;
};

}  // namespace hl
