#include <algorithm>
#include <cmath>

#include "engine/metrics/definition.h"

namespace hl {

namespace {

void finish(MetricResult& result, const ReferenceStatistics&) {
  // An estimate free of the reference's variance may fall below 0 where there is next to no error.
  result.value = std::sqrt(std::max(result.value, 0.0));
  result.noiseFloor = std::sqrt(result.noiseFloor);
  // First order about the value; about 0 the root of the square's own error is the scale.
  result.standardError = result.value > 0 ? result.standardError / (2 * result.value) : std::sqrt(result.standardError);
}

}  // namespace

const MetricDefinition kRmse{
    .info = {.id = "rmse", .label = "RMSE", .formula = "sqrt(mean (v-r)^2)", .squared = true},
    .term = [](const ChannelSample& c, const ReferenceStatistics&) { return c.squaredError(); },
    .floor = [](const ChannelSample& c, const ReferenceStatistics&) { return c.referenceVariance(); },
    .finish = finish,
    .mapped = [](double term) { return std::sqrt(std::max(term, 0.0)); },
};

}  // namespace hl
