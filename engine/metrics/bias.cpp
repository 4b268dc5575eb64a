#include "engine/metrics/definition.h"

namespace hl {

const MetricDefinition kBias{
    .info = {"bias", "Bias", "mean (v-r) / mean r, signed; mean r over pixels and channels", false},
    .term = [](const ChannelSample& c, const ReferenceStatistics& s) { return ratio(c.v - c.r, s.mean); },
};

}  // namespace hl
