#include "engine/metrics/definition.h"

namespace hl {

namespace {

/// What the term is divided by, and its derivatives by the denominator's root rho: of f(rho) = 1 / (rho^2 + e^2 + spread).
struct Inverse {
  double below, first, second;
};
Inverse inverseOf(const ChannelSample& c, const ReferenceStatistics& s) {
  const double rho = c.guess + c.own * (c.r - c.guess), floor = s.epsilon * s.epsilon + c.spread, below = rho * rho + floor;
  return {below, -2 * rho / (below * below), (6 * rho * rho - 2 * floor) / (below * below * below)};
}

/// (v-a)(v-b) f(rho), where rho has a share w of the noise of a and b, less what that adds to its mean to second order in the variance q of their mean: with
/// t = v - (the true r) that is t^2 w^2 f'' q / 2 - 2 t w f' q + w^2 f'' q^2.
double corrected(const ChannelSample& c, const ReferenceStatistics& s) {
  const Inverse f = inverseOf(c, s);
  const double square = c.squaredError(), q = c.variance, w = c.own;
  if (q == 0 || f.below == 0) return ratio(square, f.below);
  return square / f.below + 2 * (c.v - c.r) * w * f.first * q - square * w * w * f.second * q / 2 + w * w * f.second * q * q;
}

}  // namespace

const MetricDefinition kRelmse{
    .info = {.id = "relmse",
             .label = "relMSE",
             .formula = "mean (v-r)^2/(r^2+e^2), each channel by itself; e = 0.01 mean luminance of r",
             .squared = true},
    .term = corrected,
    .floor = [](const ChannelSample& c, const ReferenceStatistics& s) { return ratio(c.referenceVariance(), inverseOf(c, s).below); },
    .calmDenominator = true,
};

}  // namespace hl
