#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/placement/strategies.h"

namespace hl {

void placeGrid(const PlacementTask& task, PlacedProbes& out) {
  const ProbesParams& p = task.params;
  const vec3 side = task.bounds.max - task.bounds.min;
  const int wanted[3] = {p.count_x, p.count_y, p.count_z};
  uint64_t n[3], total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const float bySpacing = std::round(side[axis] / (p.spacing * task.longest));
    n[axis] = wanted[axis] > 0 ? static_cast<uint64_t>(wanted[axis]) : static_cast<uint64_t>(std::max(1.0f, bySpacing));
    total *= n[axis];
  }
  if (total > kMostPlacedProbes)
    throw Error(ErrorKind::TooLarge, fmt::format("probes: a grid of {} x {} x {} is more than {} probes; raise probes.spacing, or lower the counts", n[0], n[1],
                                                 n[2], kMostPlacedProbes));
  std::vector<vec3> places;
  places.reserve(total);
  for (uint64_t z = 0; z < n[2]; ++z)
    for (uint64_t y = 0; y < n[1]; ++y)
      for (uint64_t x = 0; x < n[0]; ++x) {
        const vec3 cell((static_cast<float>(x) + 0.5f) / static_cast<float>(n[0]), (static_cast<float>(y) + 0.5f) / static_cast<float>(n[1]),
                        (static_cast<float>(z) + 0.5f) / static_cast<float>(n[2]));
        places.push_back(task.bounds.min + side * cell);
      }
  keepFree(task, outsideSolids(task, places, out), out);
}

}  // namespace hl
