#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kMse{
    .info = {.id = "mse", .label = "MSE", .formula = "mean (v-r)^2", .squared = true},
    .term = [](const ChannelSample& c, const ReferenceStatistics&) { return c.squaredError(); },
    .floor = [](const ChannelSample& c, const ReferenceStatistics&) { return c.referenceVariance(); },
};

}  // namespace hl
