#include <cmath>
#include <limits>

#include "engine/metrics/definition.h"

namespace hl {

namespace {

double decibels(double meanSquare, double peak) {
  if (meanSquare <= 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(peak * peak / meanSquare);
}

void finish(MetricResult& result, const ReferenceStatistics& s) {
  const double meanSquare = result.value;
  result.value = decibels(meanSquare, s.peak);
  result.noiseFloor = std::isnan(result.noiseFloor) ? result.noiseFloor : decibels(result.noiseFloor, s.peak);
  if (result.standardError == 0) return;
  // Where nothing is left of the error, nothing is known of its size in decibels.
  result.standardError = meanSquare > 0 ? result.standardError * 10 / (std::log(10.0) * meanSquare)
                                        : std::numeric_limits<double>::infinity();
}

}  // namespace

const MetricDefinition kPsnr{
    .info = {.id = "psnr",
             .label = "PSNR [dB]",
             .formula = "10 log10(peak^2 / mean (v-r)^2); peak = largest value of r",
             .squared = true,
             .perfect = std::numeric_limits<double>::infinity()},
    .term = [](const ChannelSample& c, const ReferenceStatistics&) { return c.squaredError(); },
    .floor = [](const ChannelSample& c, const ReferenceStatistics&) { return c.referenceVariance(); },
    .finish = finish,
};

}  // namespace hl
