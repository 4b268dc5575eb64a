#include <cmath>

#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kMae{
    .info = {"mae", "MAE", "mean |v-r|", false},
    .term = [](const ChannelSample& c, const ReferenceStatistics&) { return std::fabs(c.v - c.r); },
};

}  // namespace hl
