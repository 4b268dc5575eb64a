#pragma once
// What plots of a sweep draw beside its fronts: the path tracer's curve, errors over time, axes of what was varied.
#include <string>
#include <vector>

#include "engine/sweep/summary.h"

namespace hl {

/// A sweep as it stood at a moment, with what it says: what plots draw from. Shared between threads, so never changed.
struct SweepView {
  SweepResults results;
  Summary summary;
};

/// What a plot of speed against error is of.
struct PlotChoice {
  size_t problem = 0;
  std::string reference = "matched", metric = "relmse";
  FrontAxis cost = FrontAxis::Total;
};

/// The metrics that every run has, those of the experiment first.
std::vector<std::string> plottedMetrics(const SweepResults&);
/// Whether values have a place on a logarithmic axis: those that are 0 for a perfect picture, bias by its size, what ssim lacks of 1. Not psnr.
bool isLogarithmic(const std::string& metric);

/// The path tracer by growing time: cost [ms] is the median over seeds of a count of paths, error (as badness) their mean with its interval.
struct TracerCurve {
  std::string transport;
  unsigned threads = 1;
  std::vector<uint32_t> paths;  ///< a pixel; of each point
  std::vector<CostPoint> points;
};
/// One for each set of light paths that techniques of the problem model.
std::vector<TracerCurve> tracerCurves(const SweepResults&, size_t problem, const std::string& reference, const std::string& metric);

/// A run's error while it went on (as badness).
struct ConvergenceCurve {
  size_t configuration = 0;
  uint32_t seed = 1;
  int repeat = 0;
  std::vector<double> frames, ms, errors, noiseFloors;
};
std::vector<ConvergenceCurve> convergenceCurves(const SweepResults&, size_t problem, const std::string& reference, const std::string& metric);

/// What was varied, as an axis: for each configuration a place between 0 and 1, or NaN where it does not have the key.
struct VariedAxis {
  std::string key;
  bool numeric = false, logarithmic = false;
  std::vector<std::string> values;   ///< all that occur, by their place
  std::vector<double> places;        ///< of `values`, 0 to 1
  std::vector<double> byConfiguration;
};
/// The axes of a problem's configurations, `technique` among them where it varies, in the experiment's order.
std::vector<VariedAxis> variedAxes(const SweepResults&, size_t problem);

/// "samples 64, resolution 128": of a configuration, with the last part of each key where that says enough.
std::string shortLabel(const SweepResults&, size_t configuration);
/// "samples" of "radiosity.samples", or the whole key where two keys of the sweep end alike.
std::string shortKey(const SweepResults&, const std::string& key);

}  // namespace hl
