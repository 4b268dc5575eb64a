#pragma once
// A metric's map in colours: the one place that says how an error looks, for the window and for files.
#include <vector>

#include "engine/metrics/metrics.h"

namespace hl {

/// RGBA8, rows from the top. Metrics with an end of their own (ssim, flip) from black by magma to it, signed ones from blue by white to orange, the rest by
/// viridis. Without an end of its own the scale ends where 98 % of the map's pixels (a signed one's distances from 0) are within it, so that one bright
/// pixel does not darken all others. Pixels that are not finite: magenta.
std::vector<unsigned char> errorColours(const Image& map, const MetricInfo&);

}  // namespace hl
