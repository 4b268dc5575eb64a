#pragma once
// Error metrics (MEASURES.md section 3): pure functions from images to a value and a map.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/image.h"
#include "engine/metrics/appearance.h"

namespace hl {

class TaskPool;

/// NaN in `noiseFloor` and `standardError` means: not known.
struct MetricResult {
  double value = 0;           ///< NaN where a pixel that counts is not finite; psnr of equal images is +infinity
  double noiseFloor = 0;      ///< the reference's own variance in the metric's unit; NaN without halves, and for metrics that are not squared
  /// Of `value`. Where the reference has halves: by its noise alone, that is what another run of the reference would change. Else the picture is taken
  /// for a sample, over blocks of pixels; then it is infinite where one pixel alone counts. NaN for windowed metrics with halves.
  double standardError = 0;
  uint64_t pixels = 0;        ///< that counted
  uint64_t nonFinite = 0;     ///< pixels that count with NaN or Inf in either image: any fails the comparison (value NaN)
  double epsilon = 0;         ///< as used by relmse and smape
  double peak = 0;            ///< as used by psnr: the reference's largest value, 1 where that is not positive
  Image map;                  ///< one channel, per pixel, 0 where a pixel does not count; empty unless asked for
};

/// What a reference was traced from, the same for every image of it and free of noise: which of its pixels can tell of each other. Images of its size.
struct ReferenceSurfaces {
  Image position, normal;  ///< of 3 channels or more; world space, unit geometric normals
  Image gain, offset;      ///< the reference is gain * (what varies smoothly over a surface) + offset; empty: 1 and 0. At least as many channels as it has
};

/// A reference as one image, or as two independent half-budget images whose mean it is.
struct ReferenceImage {
  Image mean;
  Image halfA, halfB;  ///< empty: the reference's variance is unknown. Their noise is independent from pixel to pixel.
  std::shared_ptr<const ReferenceSurfaces> surfaces = nullptr;  ///< null: not known
};

struct MetricInfo {
  std::string_view id, label, formula;
  bool squared = false;        ///< estimated free of the reference's variance where halves are given
  double perfect = 0;          ///< of an image against itself: 0, 1 for ssim, infinity for psnr. An image is worse the farther it is from that
  bool windowed = false;       ///< a pixel's term depends on its neighbours; needs images of 1, 3 or more channels
  bool costly = false;         ///< takes many times as long as the others: measured where it is asked for
  bool sceneReferred = false;  ///< means nothing for stored pictures
  bool mapSigned = false;      ///< the map's values have a sign that matters
  float mapEnd = 0;            ///< where colours for the map end, counted from `perfect`; 0: as the map has it
};
std::span<const MetricInfo> metricInfos();

/// What counts, and how much.
struct MeasureOptions {
  Mask mask;                   ///< where the images hold something; empty: every pixel
  std::vector<float> weights;  ///< a pixel's share, at least 0 (a texel's area); empty: all equal
  bool wantMap = false;
  double epsilon = 0;          ///< <= 0: 0.01 times the reference's mean luminance over the pixels that count
  Appearance appearance;       ///< for ssim, flip, l_star_mse; of it dfpr takes the exposure
  TaskPool* pool = nullptr;    ///< shares the work of windowed metrics; never from inside one of its tasks
};

/// RGB images (further channels are ignored; with fewer than three, those there are) of equal size. A term is taken per channel, a pixel's
/// is the mean of its channels', and the metric is (a function of) the mean over the pixels that count. Where halves A and B are given, the
/// square (v-r)^2 of a squared metric is (v-A)(v-B): its mean is free of the reference's variance, single values may be negative, and the
/// floor is the same mean with (A-B)^2/4 instead. Denominators use the mean image, in relmse with its noise taken down (denominator.h): from the
/// reference alone, so that the value is a quadratic function of the image with the same coefficients for every image. 0/0 is 0.
/// @throws Error(BadInput) for an unknown id (nearest named), unequal sizes, a mask or weights of the wrong size, or where no pixel counts.
MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference, const MeasureOptions& options);
MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference, const Mask& mask = {}, bool wantMap = false,
                     double epsilon = 0);

/// The metric over each region: pixels of it that `options.mask` has too (an empty region: all of those). Windows, the noise in denominators and
/// FLIP's exposures see all that the mask has; e, mean and peak of the reference are the region's. Costs a windowed metric one evaluation.
/// @throws as measure, naming no region: one without a pixel that counts is bad input.
std::vector<MetricResult> measureRegions(std::string_view metric, const Image& value, const ReferenceImage& reference, const MeasureOptions& options,
                                         std::span<const Mask> regions);

/// @throws Error(BadInput) naming the nearest known metric.
const MetricInfo& metricInfo(std::string_view id);

/// Pixels, from the top left corner.
struct PixelRectangle {
  int x = 0, y = 0, width = 0, height = 0;
};
/// `base` (empty: everything) inside the rectangle, 0 outside. @throws Error(BadInput) where the rectangle reaches beyond the image or is empty.
Mask rectangleMask(int width, int height, const PixelRectangle& rectangle, const Mask& base = {});

}  // namespace hl
