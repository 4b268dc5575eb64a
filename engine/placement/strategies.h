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

struct VoxelSpace;

/// Which empty spaces probes may stand in. Those whose walls show their backs are inside geometry. Of those that meet nothing but two-sided surfaces, which say
/// nothing, those that a camera is in; all where none is in any.
std::vector<bool> openSpaces(const PlacementTask&, const VoxelSpace&);

/// Those of `places` that are not in a space closed by two-sided surfaces alone (openSpaces, by voxels of ProbesParams::voxel), of which rays from one place say nothing; the rest is counted. A place in a
/// voxel that holds surface is kept. Scenes whose places all see one-sided surfaces are not voxelised.
std::vector<vec3> outsideSolids(const PlacementTask&, const std::vector<vec3>& places, PlacedProbes& out);

/// Into out.positions those of `places` that are not inside geometry, moved away from surfaces where they must be; the rest is counted.
void keepFree(const PlacementTask&, const std::vector<vec3>& places, PlacedProbes& out);

void placeVoxelGreedy(const PlacementTask&, PlacedProbes& out);
void placeGrid(const PlacementTask&, PlacedProbes& out);
void takeManual(const PlacementTask&, PlacedProbes& out);

}  // namespace hl
