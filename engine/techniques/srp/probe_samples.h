#pragma once
// What probes see: rays in the same directions for all, each probe's in its own frame (probe_frame.h), and the lumels that they hit, found once (Bennett 2019, section 5.2).
#include <string>
#include <vector>

#include "engine/techniques/technique.h"

namespace hl {

/// `count` directions spread evenly over the sphere: a spiral whose points have equal heights between them and turn by the golden angle. Products of spherical
/// harmonics are summed far better over it than over as many random directions. `seed` turns the whole set.
std::vector<vec3> sphereDirections(uint32_t count, uint32_t seed);

class ProbeSamples {
 public:
  /// Of all samples: into the open, to back faces, to surfaces without a lumel.
  struct Counts {
    uint64_t misses = 0, backFaces = 0, withoutTexel = 0;
  };
  /// `samples`: rays a probe; `order`: of the harmonics that basis() has.
  ProbeSamples(Gpu&, const SceneView&, uint32_t samples, int order, const Buffer& triangles, const Buffer& lumelOfTexel);

  uint64_t units() const { return units_; }
  uint64_t done() const { return done_; }
  void recordUnit(FrameGraph&);
  /// Drops what only units need; to be called once all are done.
  void release() { rays_ = hits_ = positions_ = directionTable_ = triangles_ = lumelOfTexel_ = {}; }
  uint64_t workingBytes() const;  ///< of that on the device, what is the scene's and the lightmap's left out
  const Buffer& codes() const { return codes_; }  ///< probes x samples: shaders/shared/lightmap_codes.h
  /// Y_j in each ray's direction, in a probe's frame, times the sample's solid angle 4 pi / N: samples x coefficients, the same for all probes.
  const Buffer& basis() const { return basis_; }
  uint32_t samples() const { return samples_; }  ///< a probe
  const Counts& counts() const;  ///< of units that are done; blocking, but asked of the device once

 private:
  Device& device_;
  SceneView scene_;
  uint32_t probes_ = 0, samples_ = 0, probesAUnit_ = 1;
  uint64_t units_ = 0, done_ = 0;
  mutable Counts counts_;
  mutable uint64_t counted_ = 0;  ///< units
  Buffer triangles_, lumelOfTexel_, positions_, directionTable_, basis_, rays_, hits_, codes_;
};

}  // namespace hl
