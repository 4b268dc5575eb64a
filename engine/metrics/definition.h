#pragma once
// What one metric is made of. Each metric's file defines one; metrics.cpp lists them and does what they share.
#include "engine/core/task_pool.h"
#include "engine/metrics/metrics.h"

namespace hl {

/// One channel at one pixel. Without halves a = b = r.
struct ChannelSample {
  double v, r;
  double a, b;
  double guess, variance, own, spread;  ///< for what divides by r, see denominator.h. Without halves `own` is 1 and the others are 0
  double squaredError() const { return (v - a) * (v - b); }
  double referenceVariance() const { return (a - b) * (a - b) / 4; }
};

/// One pixel, with one to three channels.
struct PixelSample {
  int channels;
  double v[3], r[3], a[3], b[3];
  double guess[3], variance[3], own[3], spread[3];
  double guessDraw[3];  ///< one draw of the noise in `guess`
  ChannelSample channel(int c) const { return {v[c], r[c], a[c], b[c], guess[c], variance[c], own[c], spread[c]}; }
};

/// Over the pixels that count.
struct ReferenceStatistics {
  double epsilon = 0;
  double mean = 0;  ///< of all channels
  double peak = 1;
  Screen screen;
};

/// RGB, finite everywhere: what does not count, or is not finite, is the reference's value in both pictures (0 where that is not finite either).
struct Picture {
  Image image;
  const Mask& holds;  ///< pixels that count
};
struct PictureOptions {
  Screen screen;
  float pixelsPerDegree;
  TaskPool* pool;
};

/// Has one of `term`, `pixelTerm` and `map`.
struct MetricDefinition {
  MetricInfo info;
  /// A channel's share; a pixel's is the mean of its channels'. The metric is finished from the mean over pixels.
  double (*term)(const ChannelSample&, const ReferenceStatistics&) = nullptr;
  /// The reference's share in the term, or null.
  double (*floor)(const ChannelSample&, const ReferenceStatistics&) = nullptr;
  /// Likewise of all channels at once.
  double (*pixelTerm)(const PixelSample&, const ReferenceStatistics&) = nullptr;
  double (*pixelFloor)(const PixelSample&, const ReferenceStatistics&) = nullptr;
  /// All pixels' terms, of metrics that see a pixel's neighbours.
  std::vector<double> (*map)(const Picture& value, const Picture& reference, const PictureOptions&) = nullptr;
  /// From means of terms to the metric's unit: value, noiseFloor and standardError hold those on entry. Null: they are.
  void (*finish)(MetricResult&, const ReferenceStatistics&) = nullptr;
  /// From a pixel's term to what the map shows. Null: the term.
  double (*mapped)(double term) = nullptr;
  /// Divides by the reference's pixel: a sample's `guess`, `variance`, `own` and `spread` are then as denominator.h has them, where there are halves.
  bool calmDenominator = false;
};

/// Nothing off by nothing is no error; something off by nothing is an infinite one.
inline double ratio(double numerator, double denominator) {
  return numerator == 0 && denominator == 0 ? 0 : numerator / denominator;
}

extern const MetricDefinition kMse, kRmse, kMae, kRelmse, kSmape, kBias, kPsnr, kSsim, kFlip, kFlipHdr, kLStarMse, kDfpr;

}  // namespace hl
