#pragma once
// What each placement offers, before coverage is measured. Seen by this folder's own files.
#include "engine/placement/placement.h"

namespace hl {

/// What every strategy works with.
struct PlacementTask {
  const ProbesParams& params;
  const EmbreeScene& embree;
  TaskPool& pool;
  Progress& progress;
  Bounds bounds;         ///< of the scene's surfaces, in all poses
  float longest = 0;     ///< its longest side [m]
};

/// Into out.positions those of `places` that are not inside geometry, moved away from surfaces where they must be; the rest is counted.
void keepFree(const PlacementTask&, const std::vector<vec3>& places, PlacedProbes& out);

void placeVoxelGreedy(const PlacementTask&, PlacedProbes& out);
void placeGrid(const PlacementTask&, PlacedProbes& out);
void takeManual(const PlacementTask&, PlacedProbes& out);

}  // namespace hl
