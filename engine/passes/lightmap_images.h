#pragma once
// Values at lumels as an image of the lightmap, spread past the rims of charts, and at pixels: what every technique on a lightmap shows its light with.
#include <string>
#include <utility>
#include <vector>

#include "engine/gpu/frame_graph.h"
#include "engine/lightmap/atlas.h"
#include "engine/lightmap/tables.h"
#include "engine/passes/gbuffer.h"

namespace hl {

class LightmapImages {
 public:
  /// Names of passes and resources start with "<prefix>: ". `dilation`: rings of texels, as the tables were made with. The atlas must outlive this.
  /// @throws Error(TooLarge) where the device can't hold the lightmap
  LightmapImages(Device&, std::string prefix, const Atlas&, const LightmapTables&, int dilation);

  /// Values (vec4 a lumel, in the atlas's order) to lightmap(): "<prefix>: write lightmap", "<prefix>: dilate".
  void record(FrameGraph&, const Buffer& values);
  /// Irradiance as a linear function of the normal n, c + slope . n, for recordPixels with `mapped`, in the same passes: vec4 a lumel, all lumels' slopes of red first, then of green,
  /// of blue, then their constants.
  void recordLinear(FrameGraph&, const Buffer& slopes);
  void skip(FrameGraph&, const char* reason) const;
  /// Sums (vec4 a lumel: RGB, w: number of samples) to an image of its own, not dilated, in the pass "<prefix>: write <what>".
  void recordMeans(FrameGraph&, const char* what, const Buffer& sums, const GpuImage& to) const;
  /// lightmap() at pixels, RGBA32F: bilinear within the surface's own chart, or nearest; `checker` dims every second texel and counts nothing.
  /// `mapped`: for the mapped normal, by what recordLinear has recorded; `clampNegative`: at least 0.
  void recordPixels(FrameGraph&, const std::string& pass, const GBuffer&, const GpuImage& to, bool nearest, bool checker, bool mapped = false,
                    bool clampNegative = false);
  GpuImage image(const char* name) const;  ///< of the lightmap's size, RGBA32F

  const GpuImage& lightmap() const { return dilated_; }
  const GpuImage& validity() const { return validity_; }  ///< RGBA8: valid, inside other geometry, overlapping, empty
  const GpuImage& charts() const { return charts_; }      ///< RGBA8: a colour a chart
  const Buffer& lumelOfTexel() const { return lumelOfTexel_; }
  const Buffer& chartOfTexel() const { return chartOfTexel_; }
  const Buffer& chartOfTriangle() const { return chartOfTriangle_; }
  uint32_t pixelsWithoutTexel() const;                    ///< of the last recordPixels without a checker. Blocking.
  std::vector<std::pair<std::string, uint64_t>> memory() const;

 private:
  void uploadViews(const Atlas&);
  void write(FrameGraph&, const Buffer& values, uint32_t channel, const GpuImage& to) const;
  void dilate(FrameGraph&, const GpuImage& from, const GpuImage& to, bool firstRing, bool belowZero) const;

  Device& device_;
  std::string prefix_;
  int side_, dilation_;
  Buffer lumelOfTexel_, chartOfTexel_, chartOfTriangle_, pixelCounters_;
  GpuImage linear_[4], linearSpare_;  ///< slopes of red, green and blue; constants
  GpuImage lightmap_, spare_, dilated_, validity_, charts_;
  bool counted_ = false;
};

}  // namespace hl
