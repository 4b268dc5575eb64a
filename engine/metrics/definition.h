#pragma once
// What one metric is made of. Each metric's file defines one; metrics.cpp lists them and does what they share.
#include "engine/metrics/metrics.h"

namespace hl {

/// One channel at one pixel. Without halves a = b = r.
struct ChannelSample {
  double v, r;
  double a, b;
  double squaredError() const { return (v - a) * (v - b); }
  double referenceVariance() const { return (a - b) * (a - b) / 4; }
};

/// Over the pixels that count.
struct ReferenceStatistics {
  double epsilon = 0;
  double mean = 0;  ///< of all channels
  double peak = 1;
};

struct MetricDefinition {
  MetricInfo info;
  /// A channel's share; the metric is finished from its mean.
  double (*term)(const ChannelSample&, const ReferenceStatistics&);
  /// The reference's share in the term, or null.
  double (*floor)(const ChannelSample&, const ReferenceStatistics&) = nullptr;
  /// From means of terms to the metric's unit: value, noiseFloor and standardError hold those on entry. Null: they are.
  void (*finish)(MetricResult&, const ReferenceStatistics&) = nullptr;
  /// From a pixel's term to what the map shows. Null: the term.
  double (*mapped)(double term) = nullptr;
};

/// Nothing off by nothing is no error; something off by nothing is an infinite one.
inline double ratio(double numerator, double denominator) {
  return numerator == 0 && denominator == 0 ? 0 : numerator / denominator;
}

extern const MetricDefinition kMse, kRmse, kMae, kRelmse, kSmape, kBias, kPsnr;

}  // namespace hl
