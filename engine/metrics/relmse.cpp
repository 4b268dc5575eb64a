#include "engine/metrics/definition.h"

namespace hl {

namespace {

double plain(double square, double r, const ReferenceStatistics& s) { return ratio(square, r * r + s.epsilon * s.epsilon); }

/// (v-a)(v-b) f(r), f(r) = 1 / (r^2 + e^2), where r is the mean of a and b and has their noise, less what that adds to its mean to second order in the
/// noise's variance q: with t = v - (the true r) that is t^2 f'' q / 2 - 2 t f' q + f'' q^2.
double corrected(const ChannelSample& c, const ReferenceStatistics& s) {
  const double below = c.r * c.r + s.epsilon * s.epsilon, square = c.squaredError();
  if (below == 0) return ratio(square, below);
  const double first = -2 * c.r / (below * below), second = (6 * c.r * c.r - 2 * s.epsilon * s.epsilon) / (below * below * below);
  return square / below + 2 * (c.v - c.r) * first * c.variance - square * second * c.variance / 2 + second * c.variance * c.variance;
}

double mixed(double own, double ofOwn, double ofGuess) { return own >= 1 ? ofOwn : own <= 0 ? ofGuess : own * ofOwn + (1 - own) * ofGuess; }

}  // namespace

const MetricDefinition kRelmse{
    .info = {.id = "relmse",
             .label = "relMSE",
             .formula = "mean (v-r)^2/(r^2+e^2), each channel by itself; e = 0.01 mean luminance of r",
             .squared = true},
    .term = [](const ChannelSample& c, const ReferenceStatistics& s) { return mixed(c.own, corrected(c, s), plain(c.squaredError(), c.guess, s)); },
    .floor = [](const ChannelSample& c,
                const ReferenceStatistics& s) { return mixed(c.own, plain(c.referenceVariance(), c.r, s), plain(c.referenceVariance(), c.guess, s)); },
    .calmDenominator = true,
};

}  // namespace hl
