#pragma once
// FLIP's difference of two pictures, pixel by pixel: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020.
#include "engine/core/image.h"
#include "engine/metrics/separable_filter.h"

namespace hl {

/// Of two RGB pictures in linear display values within [0, 1], of equal size: 0 (alike) to 1.
Plane flipDifference(const Image& value, const Image& reference, float pixelsPerDegree, TaskPool*);

}  // namespace hl
