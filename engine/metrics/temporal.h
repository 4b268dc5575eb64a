#pragma once
// Metrics over frames instead of pixels (MEASURES.md section 3). Both are fed one frame after the other and keep no frames.
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/image.h"

namespace hl {

struct FlickerResult {
  double value = 0;        ///< mean over pixels of std_t(L) / (mean_t(L) + e); NaN where a pixel that counts was not finite
  double epsilon = 0;      ///< 0.01 times the mean luminance over frames and pixels that count
  uint64_t nonFinite = 0;  ///< pixels that count and were not finite in some frame
  Image map;               ///< one channel, 0 where a pixel does not count
};

/// How much a picture that should stand still does not: camera and light fixed, luminance followed by pixel. std_t is the sample's (n - 1). A running mean
/// and sum of squares (Welford), in double: no drift over long runs.
class FlickerMeter {
 public:
  /// RGB (further channels are ignored), or one channel that is luminance itself. @throws Error(BadInput) where the size is not that of the frames before.
  void add(const Image& frame);
  uint64_t frames() const { return frames_; }
  /// Over the pixels of the mask (empty: all). @throws Error(BadInput) with fewer than two frames, or where no pixel counts.
  FlickerResult result(const Mask& mask = {}) const;

 private:
  int width_ = 0, height_ = 0;
  uint64_t frames_ = 0;
  std::vector<double> mean_, squares_;
};

struct StepResponse {
  double size = 0;                         ///< rms of what the step changes
  std::optional<uint64_t> frames5, frames1;  ///< the first frame (from 1) from which on at most 5 %, 1 % of the step was left; none: not within those seen
  std::vector<double> left;                ///< by frame: rms(frame - after) / rms(before - after)
  /// The same of the mean over pixels and channels, in which noise of single pixels has no part: |mean(frame - after)| / |mean(before - after)|.
  std::vector<double> meanLeft;
  std::optional<uint64_t> meanFrames5, meanFrames1;
};

/// How long a picture takes to follow a step: from `before` to `after`, both as they stand when nothing moves any more.
class TransientMeter {
 public:
  /// Over the pixels of the mask (empty: all), all channels. @throws Error(BadInput) where sizes differ, a value that counts is not finite, or the step
  /// changes nothing.
  TransientMeter(Image before, Image after, Mask mask = {});
  /// The next frame; returns the share of the step that is left. @throws Error(BadInput) for another size, Error(Run) where a value is not finite.
  double add(const Image& frame);
  /// What a frame of the settled picture would leave: the noise below which `left` cannot fall. @throws as add
  double leftBy(const Image& settled) const;
  StepResponse result() const;

 private:
  struct Difference {
    double rms = 0, mean = 0;
  };
  Difference difference(const Image&, const Image&) const;
  Image after_;
  double meanStep_ = 0;
  Mask mask_;
  StepResponse response_;
};

}  // namespace hl
