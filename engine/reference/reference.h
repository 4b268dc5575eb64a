#pragma once
// The truth: an Embree path tracer that starts from G-buffer pixels or from lightmap texels (DESIGN.md section 8).
#include <array>
#include <memory>
#include <vector>

#include "engine/core/image.h"
#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/metrics/metrics.h"
#include "engine/techniques/transport.h"
#include "engine/trace/embree_scene.h"

namespace hl {

/// Where irradiance is wanted. The back of a one-sided surface stays zero, and with ReferenceSettings::frontFacesOnly every back does. Invalid receivers (no surface) have a zero normal and stay zero.
struct Receiver {
  vec3 position{0.0f}, geometricNormal{0.0f}, mappedNormal{0.0f};
  bool backFace = false;  ///< the camera sees the surface's back (normals are turned towards the camera)
  bool twoSided = false;
  /// The lobe of a glossy surface (Material::specular, roughness), and where its light is wanted: towards the camera, unit. Without a view there is no lobe.
  vec3 view{0.0f}, specular{0.0f};
  float roughness = kDefaultRoughness;
  bool glossy() const { return view != vec3(0.0f) && specular != vec3(0.0f); }
};

struct ReferenceSettings {
  int samplesPerPixel = 256;   ///< in all, at least 2 (odd: one more); half of them go to each of the two halves
  int maxBounces = kAllBounces;
  uint64_t seed = 1;
  bool frontFacesOnly = false;
  ReceiverNormal receiver = ReceiverNormal::Mapped;
  bool glossyLastBounce = true;  ///< also radiance by the lobes of glossy receivers, with as many paths again; without such receivers it means nothing
  int directSamples = 64;      ///< of emissive surfaces and sky a receiver, for the direct image, in all; punctual lights are exact
};

/// Irradiance [W/m^2] by bounce: bucket b holds the light that was reflected b + 1 times before it reached the receiver (the last: all more).
struct ReferenceResult {
  int width = 0, height = 0;
  int samplesPerPixel = 0;     ///< reached so far
  Image direct[2];             ///< direct irradiance, two independent halves (RGB)
  std::array<Image, kBounceBuckets> indirect[2];
  /// By the same bounces, radiance [W/(sr m^2)] towards the camera of what the receiver's lobe reflects. Emission and sky seen in the lobe are direct light, and not in it. Images
  /// without pixels where no receiver is glossy, or settings.glossyLastBounce is off.
  std::array<Image, kBounceBuckets> specular[2];
  /// What those lobes reflect of lamps, emission, sky and environment map without a bounce [W/(sr m^2)]; likewise.
  Image directSpecular[2];
  uint64_t backFaceHits = 0;   ///< paths that ended on the back of a one-sided surface (of any, where front faces alone count)
  uint64_t nonFinite = 0;      ///< contributions that were NaN or Inf, and left out
  uint64_t paths = 0, rays = 0;  ///< that the result took, shadow rays included
  std::string key;             ///< what it depends on; the cache's key

  ReferenceImage directImage() const;
  /// Sum of the buckets up to `bounces`.
  ReferenceImage indirectImage(int bounces) const;
  bool glossy() const { return specular[0][0].pixels() > 0; }
  /// As indirectImage, of `specular`; black where there is none.
  ReferenceImage specularImage(int bounces) const;
  ReferenceImage directSpecularImage() const;  ///< without pixels where there is none
};

/// Progressive and resumable: each `advance` adds one numbered pass (a fixed number of samples a pixel). The result after pass n does not depend
/// on slices, threads or cancellation.
///
/// receiver == Mapped weighs light with the mapped (or smooth) normal at the receiver and at every bounce; Geometric with the triangle's own; MappedAtReceiver with each where its name says.
class ReferenceTracer {
 public:
  /// @throws Error(BadInput) where the receivers are not width x height.
  ReferenceTracer(std::shared_ptr<const EmbreeScene>, std::vector<Receiver> receivers, int width, int height, const ReferenceSettings&, TaskPool&);
  ~ReferenceTracer();
  /// Starts from a cached result where one with the same key and at most as many samples is on disk. A damaged one is passed over with a warning.
  void resume();
  bool settled() const;
  /// One unit: at most about 100 ms of work on one core; a band of rows of the pass. Cancelled through `progress` it leaves what was done.
  void advance(Progress&);
  double done() const;  ///< 0 to 1
  /// Whole passes so far; the images are consistent. Null before the first pass is complete.
  /// After a resume from a file that was stored in the middle of a pass, receivers differ by one pass in their sample count until that one is complete.
  std::shared_ptr<const ReferenceResult> result() const;
  void store() const;   ///< to the disk cache, atomically
 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
