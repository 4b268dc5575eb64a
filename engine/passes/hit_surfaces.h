#pragma once
// Rays and what they hit, as surfaces that receive direct light and reflect it: what a technique needs to shade ray hits.
#include <string>
#include <utility>
#include <vector>

#include "engine/gpu/frame_graph.h"
#include "engine/passes/direct_light.h"
#include "engine/scene/gpu_scene.h"

namespace hl {

/// Radiance that a hit i sends back along its ray, as far as it is reflected light: albedo / pi * (direct / samples + what a cache knows of indirect
/// light there). Emission seen by the ray and the sky where it missed are direct light of the ray's origin, and no part of this.
class HitSurfaces {
 public:
  HitSurfaces(Device&, const GpuScene&, DirectLight&);

  /// Some of the rays of a batch, and what each hit (Tracer::record, closest).
  struct Rays {
    Buffer rays;             ///< shared::Ray
    Buffer hits;             ///< shared::Hit
    uint32_t first = 0;      ///< ray `first` + i becomes point i
    uint32_t count = 0;
    float offset = 0;        ///< how far in front of a hit its own rays start [m]
    uint32_t seed = 1;       ///< of the points' random sequences, with their index: batches that share a frame need different ones
    uint32_t sample = 0;     ///< index in those sequences: one sample of every light a hit, all punctual lights
  };
  /// Fills points(), albedo() and direct(). Passes "<prefix>: surfaces", "<prefix>: clear direct", and those of DirectLight::record.
  /// The buffers grow to the largest batch and are written anew by each. @throws Error(TooLarge) where a buffer of the device can't hold the batch
  void record(FrameGraph&, const std::string& prefix, const Rays&);

  const Buffer& points() const { return points_; }    ///< shared::SurfacePoint; flags: shaders/passes/hit_surfaces.h; zero normals where nothing reflects
  const Buffer& albedo() const { return albedo_; }    ///< vec4: RGB at most kMaxAlbedo, w: 1 where the surface reflects, else 0 (and RGB too)
  const Buffer& direct() const { return direct_; }    ///< vec4: irradiance summed over samples, w: their number
  uint64_t largestBatch() const;                      ///< in rays

  /// Since the last reset: "hits_nothing" and "hits_back_face" (of one-sided materials). Blocking.
  std::vector<std::pair<std::string, double>> counters() const;
  void resetCounters() { countersStale_ = true; }
  std::vector<std::pair<std::string, uint64_t>> memory() const;

 private:
  void reserve(const std::string& prefix, uint32_t count);

  Device& device_;
  const GpuScene& scene_;
  DirectLight& light_;
  Buffer points_, albedo_, direct_, counters_;
  bool countersStale_ = true;
};

}  // namespace hl
