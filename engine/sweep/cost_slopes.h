#pragma once
// How cost grows with what a sweep varies: slopes of straight lines in both logarithms.
#include <string>
#include <utility>
#include <vector>

#include "engine/sweep/summary.h"

namespace hl {

/// Of configurations that differ in one parameter alone.
struct CostSlope {
  size_t problem = 0;
  std::string key;       ///< the parameter
  std::string fixed;     ///< what else the sweep varies, as it was held here: "srp.compression none"; empty where all of it was as in the base
  std::string quantity;  ///< what the cost is plotted over: "bands" (order + 1), "probes", "receivers", "lumels" as the technique counted them, else the parameter itself
  std::string cost;      ///< "technique_ms" (own passes of a frame), "bake_ms" (preparation and work), "technique_bytes"
  std::vector<std::pair<double, double>> points;  ///< by growing quantity
  double slope = 0, standardError = 0;            ///< the latter NaN for two points
};

/// Least squares of log(cost) on log(quantity), where a parameter takes at least three different values and nothing else changes. Costs of 0 are left out.
std::vector<CostSlope> costSlopes(const SweepResults&, const Summary&);
/// Slope and its standard error. @param points both above 0
std::pair<double, double> logLogSlope(const std::vector<std::pair<double, double>>& points);

/// The configuration of least cost whose error (the experiment's first metric, by its size, with its interval) is at most the experiment's target.
struct WithinTarget {
  size_t problem = 0;
  std::string reference;
  FrontAxis axis = FrontAxis::Memory;
  std::optional<size_t> configuration;  ///< none: all are above it
  double cost = 0, error = 0;
};
/// For each problem, reference and cost; empty where the experiment has no target_error.
std::vector<WithinTarget> withinTarget(const SweepResults&, const Summary&);

}  // namespace hl
