#pragma once
// A noisy reference below the line.
#include "engine/metrics/metrics.h"

namespace hl {

/// What a reference in two halves says of itself. Images of its size, with up to three channels.
struct CalmedReference {
  Image guess;     ///< at a pixel, from all but the pixel
  Image noise;     ///< one draw of the noise in it
  Image variance;  ///< of the reference's mean, round the pixel
  Image own;       ///< how far the pixel itself is to be trusted below the line: 0 to 1
};

/// Where a reference pixel is dark by the luck of few paths, 1/r^2 is wildly too large; and even a little of the noise that the denominator shares with
/// the term above it outweighs a small error. While the reference's relative standard deviation is above kUncertain, the denominator therefore comes from
/// the pixel's neighbours: the value's own pixel times the ratio of the reference's and the value's sums over the others of 5 x 5 (the ratio
/// estimator of survey sampling). The value has the picture's edges and none of the reference's noise; the ratio takes out what it gets wrong. The
/// value's own noise is smoothed first, within edges (a bilateral filter). Below kCertain the pixel's own value is used, and its bias, known to second order from
/// the variance, is taken out by the metric; in between the two are mixed. In the limit it is the plain definition. Pixels without weight, and such as are
/// not finite, are left out.
CalmedReference calmedReference(const Image& value, const ReferenceImage& reference, const std::vector<double>& weights, TaskPool* pool);

inline constexpr float kCertain = 0.07f, kUncertain = 0.14f;

}  // namespace hl
