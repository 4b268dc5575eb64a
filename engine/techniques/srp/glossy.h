#pragma once
// Receivers on glossy surfaces (srp.receivers `radiance`): which those are, and what the camera sees reflected of the light that they know.
#include <cstdint>
#include <span>
#include <vector>

#include "engine/lightmap/tables.h"
#include "engine/passes/lightmap_images.h"
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/technique.h"

namespace hl {

/// By lumel: whether its receiver has more rows than that of irradiance, as all directional ones have, and those on glossy surfaces where receivers are `radiance`. Empty: none has.
std::vector<uint8_t> wideLumels(const SceneView&, const SrpParams&);

class Reflection {
 public:
  Reflection(Device&, const SceneView&, const ReceiverClusters&, const LightmapTables&);

  bool any() const { return static_cast<bool>(normals_); }  ///< whether any receiver is on a glossy surface
  /// Pass "srp: reflect": radiance [W/(sr m^2)] towards the camera of what lobes reflect of `incident` (SrpRuntime::incident), at the pixels of a G-buffer with a `specular` image.
  void record(FrameGraph&, const GBuffer&, const Camera&, const LightmapImages&, const Buffer& incident, const SrpParams&, const GpuImage& to);
  struct Counts {
    uint32_t negative = 0, nonFinite = 0, withoutTexel = 0;  ///< pixels
  };
  Counts counts() const;  ///< in the last frame. Blocking.
  uint64_t bytes() const { return any() ? glossyOfTexel_.size() + normals_.size() + counters_.size() : 0; }

 private:
  Device& device_;
  Buffer glossyOfTexel_, normals_, counters_;
  bool counted_ = false;
};

}  // namespace hl
