#include "engine/sweep/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hl {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Probability that |t| stays below `t` with `n` degrees of freedom: the closed sums (Abramowitz and Stegun 26.7.3 and 26.7.4).
double twoSided(double t, int n) {
  const double angle = std::atan(t / std::sqrt(static_cast<double>(n)));
  const double s = std::sin(angle), c2 = std::cos(angle) * std::cos(angle);
  double sum = 0;
  if (n % 2 == 1) {
    double term = std::cos(angle);
    for (int k = 1; k <= n - 2; k += 2) sum += term, term *= c2 * (k + 1) / (k + 2);
    return 2 / std::numbers::pi * (angle + s * sum);
  }
  double term = 1;
  for (int k = 0; k <= n - 2; k += 2) sum += term, term *= c2 * (k + 1) / (k + 2);
  return s * sum;
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<size_t>(at);
  const size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace

double studentT95(int degrees) {
  if (degrees < 1) return kNan;
  double low = 1.9, high = 13;  // from infinitely many degrees of freedom to one
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (twoSided(middle, degrees) < 0.95 ? low : high) = middle;
  }
  return (low + high) / 2;
}

Estimate meanOf(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  if (values.empty()) return {kNan, kNan, 0};
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const int samples = static_cast<int>(values.size());
  return {mean, samples < 2 ? kNan : studentT95(samples - 1) * std::sqrt(squares / (n - 1) / n), samples};
}

Spread spreadOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5), quantile(values, 0.05), quantile(values, 0.95)};
}

Estimate jackknife(int count, int least, const std::function<double(int)>& statistic) {
  Estimate out{statistic(-1), kNan, count};
  if (count < std::max(2, least)) return out;
  std::vector<double> without;
  double mean = 0;
  for (int k = 0; k < count; ++k) without.push_back(statistic(k)), mean += without.back() / count;
  double squares = 0;
  for (const double v : without) squares += (v - mean) * (v - mean);
  out.halfWidth = studentT95(count - 1) * std::sqrt(squares * (count - 1) / count);
  return out;
}

}  // namespace hl
