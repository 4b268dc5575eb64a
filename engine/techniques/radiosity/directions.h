#pragma once
// Sets of directions for gathering: points of the unit disc, which lifted to the hemisphere are cosine distributed, each with its weight.
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/core/math.h"
#include "engine/core/progress.h"

namespace hl {

/// Points of the unit square, a rank-1 lattice along the golden ratio (i / n, frac(i phi)): evenly spread for every count and under every
/// toroidal shift. Ordered along a Hilbert curve, so that neighbouring rays stay close.
std::vector<vec2> goldenLattice(uint32_t count);

struct DiscDirection {
  glm::dvec2 p{0.0};  ///< in the disc; the direction is (p, sqrt(1 - p^2)) round the normal
  double weight = 0;  ///< all of them sum to 1
};

/// Each point after four random ones in the middle of the largest empty circle of the unit disc (Laine et al. 2007, "Incremental Instant
/// Radiosity", section 4; Kahl 2023, algorithm 9), in the order found. Many lie on the rim, so the points alone are not uniform. Unless
/// `unweighted` (the thesis), each stands for its Voronoi cell within the disc: its weight is the cell's area, its height the mean height
/// of the cell and its azimuth that of the cell's centroid; then sum w z is exactly 2/3. O(count^2): 4096 take about a second.
std::vector<DiscDirection> largestEmptyCircles(uint32_t count, bool unweighted, const Progress* = nullptr);

/// Position of a point of the unit square along a Hilbert curve of 2^16 steps a side.
uint32_t hilbertIndex(vec2 p);

}  // namespace hl
