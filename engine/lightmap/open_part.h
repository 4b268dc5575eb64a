#pragma once
// Texels that other geometry covers in part: where a wall stands on a floor, the part in front of the wall is seen and needs a value of its own.
#include "engine/lightmap/atlas.h"

namespace hl {

/// For texels along the border between those in the open and those marked inside other geometry: where some of their points are in the open and some
/// are not, position and area become those of the open part (the mean of its points, or the one nearest to the mean where that is covered itself) and
/// `inside` 0. `cornerUvs` as Atlas has them; points that the centroid's own triangle does not hold are left out. A part that is all covered, as its centroid
/// is, stays as it is. Returns how many texels were marked inside and are not any more. @throws Error(Cancelled)
uint64_t openCoveredTexels(const Scene&, const std::vector<vec2>& cornerUvs, int resolution, std::vector<Lumel>& lumels, std::vector<uint8_t>& inside,
                           const FindInside& findInside, Progress&);

}  // namespace hl
