#pragma once
// Direct light as a service: irradiance from punctual lights, emissive triangles and sky at any set of points, with ray-traced shadows.
#include "engine/gpu/frame_graph.h"
#include "engine/params/groups.h"
#include "engine/passes/gbuffer.h"
#include "engine/scene/gpu_scene.h"
#include "engine/trace/tracer.h"

namespace hl {

class DirectLight {
 public:
  DirectLight(Device&, ShaderLibrary&, const GpuScene&, Tracer&);
  ~DirectLight();

  /// Irradiance at `count` points [first, first + count) of `points` (shared::SurfacePoint), added to `irradiance` (vec4 a point: RGB sum, w = samples):
  /// one sample of every light a call. Clear `irradiance` first. Passes "<prefix>: sample lights", "<prefix>: shadow rays", "<prefix>: accumulate".
  void record(FrameGraph&, const std::string& prefix, const Buffer& points, const Buffer& irradiance, uint32_t first, uint32_t count, uint32_t seed,
              uint32_t sample);

  /// Irradiance at G-buffer pixels: punctual lights by one ray each, emitters and sky as a running mean over
  /// frames since `reset` up to `params.samples` samples; then skipped as settled. Passes "direct punctual: ...", "direct: ...".
  GpuImage recordPixels(FrameGraph&, const GBuffer&, const DirectParams&, uint32_t seed);
  /// Radiance towards `eye` [W/(sr m^2)] that the lobes of glossy pixels reflect of lamps, emission, sky and environment map, without a bounce: punctual lights by one ray each, the rest
  /// by rays to emitters and rays of the lobe, weighed by both densities, as the same running mean. Call it in each frame, after recordPixels. Empty where the scene has no
  /// glossy surfaces. Passes "direct specular punctual: ...", "direct specular: ...".
  GpuImage recordSpecular(FrameGraph&, const GBuffer&, vec3 eye, const DirectParams&, uint32_t seed);
  void reset();
  bool settled(const DirectParams&) const;
  /// Only punctual lights, or none: further samples would repeat the first.
  bool exactAfterOneSample() const;
  std::vector<std::pair<std::string, uint64_t>> memory() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
