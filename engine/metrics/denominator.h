#pragma once
// A noisy reference below the line.
#include "engine/metrics/metrics.h"

namespace hl {

/// What stands below the line, from the reference alone, so that all images are divided by the same. Images of its size, with up to three channels.
/// Below a pixel's term stands rho^2 + e^2 + spread, where rho = guess + own (r - guess).
struct CalmedReference {
  Image guess;     ///< the reference at a pixel, from its neighbours without the pixel itself
  Image own;       ///< the share of the pixel's own value, 0 to 1
  Image variance;  ///< of the reference's mean, round the pixel: what the noise in `own` adds to the term is taken out with it
  Image spread;    ///< what the noise in `guess` adds to the mean of 1 / (rho^2 + e^2), to second order, is taken out with it
  Image noise;     ///< one draw of the noise in `guess`
};

/// Where a reference pixel is dark by the luck of few paths, 1/r^2 is wildly too large; and even a little of the noise that the denominator shares with
/// the term above it outweighs a small error. The guess is a plane fitted to the other pixels of 5 x 5 that lie on the same surface (those whose normals and
/// positions say so, where the reference knows them), read off at the pixel: its noise is not the term's. Of the pixel's own value goes in as much as keeps
/// its noise at kOwnNoise of the guess; and all of it where it is so much darker than the guess that it cannot be by luck. The share's correlation with the term is known to second
/// order, and the metric takes it out. In the limit it is the plain definition. Pixels without weight, and such as are not finite, are left out.
CalmedReference calmedReference(const ReferenceImage& reference, const std::vector<double>& weights, TaskPool* pool);

/// Relative standard deviation.
inline constexpr double kOwnNoise = 0.1;

}  // namespace hl
