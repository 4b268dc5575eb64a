#pragma once
// Charts made from the mesh alone: connected triangles that face roughly the same way, laid flat by a projection along their mean normal.
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/core/progress.h"
#include "engine/scene/scene.h"

namespace hl {

struct Chart {
  std::vector<uint32_t> triangles;
  glm::dvec2 size{0.0};  ///< of its bounding rectangle [m], turned so that the rectangle is smallest; x is the longer side
  double area = 0;       ///< of its triangles in the world [m^2]
};

struct ChartSet {
  std::vector<Chart> charts;
  std::vector<glm::dvec2> corners;      ///< 3 a triangle, in its chart's rectangle [m]
  std::vector<uint32_t> chartOfTriangle;  ///< kNone for triangles without area
};

/// `texelsPerMetre`: about the density the charts will get; overlaps are looked for at four times that.
/// Deterministic. @throws Error(Cancelled)
ChartSet makeCharts(const Scene&, double texelsPerMetre, Progress&);

}  // namespace hl
