#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kMse{
    .info = {"mse", "MSE", "mean (v-r)^2", true},
    .term = [](const ChannelSample& c, const ReferenceStatistics&) { return c.squaredError(); },
    .floor = [](const ChannelSample& c, const ReferenceStatistics&) { return c.referenceVariance(); },
};

}  // namespace hl
