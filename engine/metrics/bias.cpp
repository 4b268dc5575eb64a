#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kBias{
    .info = {.id = "bias", .label = "Bias", .formula = "mean (v-r) / mean r, signed; mean r over pixels and channels", .mapSigned = true},
    .term = [](const ChannelSample& c, const ReferenceStatistics& s) { return ratio(c.v - c.r, s.mean); },
};

}  // namespace hl
