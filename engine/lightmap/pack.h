#pragma once
// Rectangles into a square: a skyline, at the largest scale that fits.
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/core/math.h"
#include "engine/core/progress.h"

namespace hl {

/// Where a chart went: texel = origin + point * scale, with the point in the chart's own rectangle [m].
struct Placement {
  bool placed = false;
  glm::dvec2 origin{0.0}, scale{0.0};
  ivec2 cell{0}, cellSize{0};  ///< the texels reserved for it, without the margin
};

struct Packing {
  std::vector<Placement> placements;  ///< one a rectangle
  double texelsPerMetre = 0;
  int margin = 0;                     ///< texels kept free between any two; less than asked where that cost too much density
};

/// `sizes` [m]. Rectangles of less than half a texel are stretched to that, so that float coordinates can tell their corners apart; those of
/// four texels and more are rounded to whole texels a side. Where not even one texel each fits, the last ones in order of size are not placed.
Packing packRectangles(const std::vector<glm::dvec2>& sizes, int resolution, int margin, Progress&);

}  // namespace hl
