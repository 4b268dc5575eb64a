#pragma once
// Intervals for what a few seeds or repeats say.
#include <functional>
#include <span>
#include <vector>

namespace hl {

/// A mean with the half-width of its 95 % confidence interval (Student's t). One sample has no spread: `halfWidth` is then NaN.
struct Estimate {
  double mean = 0, halfWidth = 0;
  int samples = 0;
};
Estimate meanOf(std::span<const double>);

/// Two-sided 95 % quantile of Student's t with `degrees` >= 1 degrees of freedom: 12.706, 4.303, 3.182 ... 1.960.
double studentT95(int degrees);

/// Median with the 5th and 95th percentile, between the two nearest samples. All zero without samples.
struct Spread {
  double median = 0, p5 = 0, p95 = 0;
};
Spread spreadOf(std::vector<double>);

/// An estimate from the whole, and its interval by leaving out one of the `count` samples at a time (the jackknife, with t of count - 1 degrees of
/// freedom). `statistic(k)` is the statistic without sample k; `statistic(-1)` of all. The interval is NaN for fewer than `least` samples, where leaving
/// one out leaves too few.
Estimate jackknife(int count, int least, const std::function<double(int without)>& statistic);

}  // namespace hl
