#pragma once
// What a sweep's runs say together: means over seeds with intervals, bias and variance, fronts, tables.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/pareto.h"
#include "engine/sweep/statistics.h"
#include "engine/sweep/sweep.h"

namespace hl {

struct ErrorSummary {
  std::string reference, target, component, metric, roi;
  Estimate value;            ///< over seeds
  double noiseFloor = 0;     ///< of the reference
  double standardError = 0;  ///< by the reference's noise; the same reference serves all configurations, so it moves them together
};

/// Squared error of indirect light in its parts, in the unit of mse: mean over pixels and channels. README.md says how.
struct BiasVariance {
  std::string reference;
  Estimate biasSquared, variance;
};

/// The path tracer with the time that a configuration took.
struct EqualTime {
  std::string reference;
  Estimate value;           ///< of the front's metric, over seeds
  double paths = 0, ms = 0; ///< a pixel; where one path a pixel took longer than the configuration, ms says how long
};

/// A pass over the runs that recorded it: of their medians.
struct PassSummary {
  std::string name, where;
  Spread ms;
  double bytes = 0;  ///< that it moves; 0: not stated
  double share = 1;  ///< of frames, those in which it ran
  double gbps() const { return ms.median > 0 ? bytes / (1e6 * ms.median) : 0; }
};

struct ConfigurationSummary {
  size_t configuration = 0, problem = 0;
  int runs = 0, failed = 0;
  std::string failure;       ///< the first
  Spread frameMs, techniqueMs, prepareMs, workMs, totalMs;  ///< over runs; frameMs: of the runs' medians
  double frameMedianMs = 0;  ///< half-width that a run's own median has, by the spread of its frames: runs may agree by chance
  double unaccounted = 0;    ///< share of a frame's time that is in no pass, at most over runs
  std::vector<PassSummary> passes, workPasses;  ///< of a frame; of a unit of work
  double frames = 0;         ///< until the stop rule
  double deviceBytes = 0, techniqueBytes = 0;
  std::vector<ErrorSummary> errors;
  std::vector<BiasVariance> parts;
  std::vector<EqualTime> pathTracer;
  double bakeMs() const { return prepareMs.median + workMs.median; }
  double amortisedMs(int frames_) const { return frameMs.median + bakeMs() / frames_; }
};

enum class FrontAxis { Frame, Total, Amortised, Memory };
inline constexpr std::array<const char*, 4> kFrontAxes = {"frame_ms", "total_ms", "amortised_ms", "technique_bytes"};

struct FrontPoint {
  size_t configuration = 0;
  CostPoint point;
  FrontPlace place = FrontPlace::On;
};
struct Front {
  size_t problem = 0;
  FrontAxis axis = FrontAxis::Total;
  std::string reference, metric;
  std::vector<FrontPoint> points;  ///< by growing cost
};

/// Speed against relative error (the root of relmse) of one competitor on one problem.
struct SpeedTable {
  size_t problem = 0;
  std::string competitor;  ///< a technique's id, or "path_tracer (host, 2 threads, 8 bounces, ...)"
  std::string reference;
  FrontAxis axis = FrontAxis::Total;
  std::vector<CostPoint> envelope;                         ///< [ms], share
  std::vector<std::pair<double, std::optional<double>>> errorAt;  ///< at so many ms
  std::vector<std::pair<double, std::optional<double>>> msTo;     ///< to such a share
  std::optional<double> least;                             ///< where it levels off
};

struct Summary {
  std::vector<ConfigurationSummary> configurations;
  std::vector<Front> fronts;
  std::vector<SpeedTable> tables;
};

/// Reads the pictures that bias and variance need from the folder; where one is missing, a configuration has none.
Summary summarise(const SweepResults&);

/// Over runs, in ms or bytes.
Spread costOf(const ConfigurationSummary&, FrontAxis, int amortiseFrames);
/// The front of any metric that the runs measured, of indirect light over the whole picture. Configurations without that error have no point.
Front frontOf(const SweepResults&, const Summary&, size_t problem, FrontAxis, const std::string& reference, const std::string& metric);

/// Smaller is better: the metric's value; its size for bias; for what grows with likeness what it lacks of perfect, or its negative where that is infinite.
double badness(const std::string& metric, double value);

/// Of images of one picture under different seeds (equal sizes): the variance of a pixel's channel, meant over `pixels` of them, by the sample variance;
/// and the square of the bias, which is the mean squared error less that. `mse`: of each image. Intervals by the jackknife over seeds, from three on;
/// `referenceError`: standard error of the mse by the reference's noise, which the bias gets besides.
BiasVariance biasAndVariance(const std::vector<Image>& images, double pixels, const std::vector<double>& mse, double referenceError);

}  // namespace hl
