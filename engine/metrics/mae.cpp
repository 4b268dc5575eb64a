#include <cmath>

#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kMae{
    .info = {.id = "mae", .label = "MAE", .formula = "mean |v-r|"},
    .term = [](const ChannelSample& c, const ReferenceStatistics&) { return std::fabs(c.v - c.r); },
};

}  // namespace hl
