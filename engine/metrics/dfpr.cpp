#include <cmath>

#include "engine/metrics/definition.h"

namespace hl {

// Deviation from pure radiosity: Kahl's thesis on RTRad, equation 6.1. There lightmaps hold at most 1 a channel, so that it ends at sqrt 3; here
// light is measured after the exposure, and nothing is cut off.
const MetricDefinition kDfpr{
    .info = {.id = "dfpr", .label = "DFPR", .formula = "mean |v-r| as a distance in RGB, after the exposure; r is the lightmap of pure radiosity"},
    .pixelTerm =
        [](const PixelSample& p, const ReferenceStatistics& s) {
          double sum = 0;
          for (int c = 0; c < p.channels; ++c) sum += (p.v[c] - p.r[c]) * (p.v[c] - p.r[c]);
          return std::sqrt(sum) * static_cast<double>(s.screen.scale());
        },
};

}  // namespace hl
