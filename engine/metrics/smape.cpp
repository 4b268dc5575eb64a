#include <cmath>

#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kSmape{
    .info = {.id = "smape", .label = "SMAPE", .formula = "mean 2|v-r|/(|v|+|r|+e), each channel by itself; e = 0.01 mean luminance of r"},
    .term =
        [](const ChannelSample& c, const ReferenceStatistics& s) {
          return ratio(2 * std::fabs(c.v - c.r), std::fabs(c.v) + std::fabs(c.r) + s.epsilon);
        },
};

}  // namespace hl
