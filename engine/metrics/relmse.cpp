#include "engine/metrics/definition.h"

namespace hl {

namespace {

double relative(double square, const ChannelSample& c, const ReferenceStatistics& s) {
  return ratio(square, c.r * c.r + s.epsilon * s.epsilon);
}

}  // namespace

const MetricDefinition kRelmse{
    .info = {"relmse", "relMSE", "mean (v-r)^2/(r^2+e^2), each channel by itself; e = 0.01 mean luminance of r", true},
    .term = [](const ChannelSample& c, const ReferenceStatistics& s) { return relative(c.squaredError(), c, s); },
    .floor = [](const ChannelSample& c, const ReferenceStatistics& s) { return relative(c.referenceVariance(), c, s); },
};

}  // namespace hl
