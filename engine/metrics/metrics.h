#pragma once
// Error metrics (MEASURES.md section 3): pure functions from images to a value and a map.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/image.h"

namespace hl {

struct MetricResult {
  double value = 0;
  double noiseFloor = 0;      ///< the reference's own variance in the metric's unit; 0 where it does not apply
  double standardError = 0;   ///< of `value`, over blocks of pixels
  uint64_t pixels = 0;        ///< that counted
  uint64_t nonFinite = 0;     ///< pixels with NaN or Inf in either image: any fails the comparison
  Image map;                  ///< one channel, per pixel; empty unless asked for
};

/// A reference as one image, or as two independent half-budget images whose mean it is.
struct ReferenceImage {
  Image mean;
  Image halfA, halfB;  ///< empty: the reference's variance is unknown, and the noise floor is 0
};

struct MetricInfo {
  std::string_view id, label, formula;
  bool squared;  ///< estimated free of the reference's variance where halves are given
};
std::span<const MetricInfo> metricInfos();

/// RGB images (further channels are ignored) of equal size. `epsilon` <= 0: 0.01 times the reference's mean luminance.
/// @throws Error(BadInput) for an unknown id (nearest named), unequal sizes, a mask of the wrong size or an empty mask.
MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference, const Mask& mask = {}, bool wantMap = false,
                     double epsilon = 0);

}  // namespace hl
