#pragma once
// What each texel of a lightmap covers, by clipping every triangle to every texel it touches.
#include <cstdint>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/lightmap/atlas.h"
#include "engine/scene/scene.h"

namespace hl {

struct Coverage {
  std::vector<Lumel> lumels;       ///< every texel with covered area, in texel order
  std::vector<uint8_t> overlaps;   ///< one a lumel: 1 where two triangles claim the same point of the texel
  uint64_t overlapping = 0;
  double area = 0, uncoveredArea = 0;         ///< world [m^2]
  double flatArea = 0;                        ///< world area of triangles that the coordinates fold to a line or a point [m^2]
  double densityMean = 0, densitySpread = 0;  ///< texels per metre; mean and relative standard deviation, weighted by area
};

/// `cornerUvs`: 3 a triangle; what lies outside [0, 1] is not covered. Triangles marked in `unplaced` (empty: none)
/// are left out and count as uncovered.
/// The result does not depend on the number of threads. @throws Error(Cancelled)
Coverage coverTexels(const Scene&, const std::vector<vec2>& cornerUvs, const std::vector<uint8_t>& unplaced, int resolution, TaskPool&, Progress&);

}  // namespace hl
