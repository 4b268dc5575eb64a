// Which empty spaces are inside geometry, judged as wholes.
#include <algorithm>

#include "engine/placement/free_space.h"
#include "engine/placement/strategies.h"
#include "engine/placement/voxels.h"

namespace hl {
namespace {

/// Voxels of a space that are asked whether it is inside geometry: the middle ones of so many equal pieces of it.
constexpr size_t kAsked = 64;

}  // namespace

std::vector<bool> openSpaces(const PlacementTask& task, const VoxelSpace& s) {
  std::vector<std::vector<size_t>> voxels(s.spaces);
  std::vector<size_t> sizes(s.spaces, 0);
  for (const uint32_t id : s.space)
    if (id != kSurfaceVoxel) ++sizes[id];
  std::vector<size_t> seen(s.spaces, 0);
  for (size_t i = 0; i < s.space.size(); ++i) {
    const uint32_t id = s.space[i];
    if (id == kSurfaceVoxel) continue;
    const size_t step = (sizes[id] + kAsked - 1) / kAsked;
    if (seen[id]++ % step == step / 2) voxels[id].push_back(i);
  }
  std::vector<bool> camera(s.spaces, false);
  bool anyCamera = false;
  for (const Camera& c : task.embree.scene().cameras) {
    const ivec3 v = s.voxelOf(c.position);
    // One beside the bounds stands in the outermost layer's space.
    const uint32_t id = s.space[s.index(glm::clamp(v, ivec3(0), s.counts - 1))];
    if (id != kSurfaceVoxel) camera[id] = anyCamera = true;
  }
  std::vector<bool> open(s.spaces, false);
  std::vector<vec3> places;
  for (uint32_t id = 0; id < s.spaces; ++id) {
    places.clear();
    for (const size_t v : voxels[id]) places.push_back(s.centre(s.at(v)));
    float backs = 0, fronts = 0;
    for (const Surroundings& a : lookAround(task.embree, places, task.pool, task.progress)) backs += a.backs, fronts += a.fronts;
    const auto n = static_cast<float>(std::max<size_t>(places.size(), 1));
    open[id] = backs < task.params.inside_threshold * n && (fronts > 0 || camera[id] || !anyCamera);
  }
  return open;
}

std::vector<vec3> outsideSolids(const PlacementTask& task, const std::vector<vec3>& places, PlacedProbes& out) {
  const std::vector<Surroundings> around = lookAround(task.embree, places, task.pool, task.progress);
  const auto tells = [](const Surroundings& a) { return a.backs > 0 || a.fronts > 0; };
  if (std::all_of(around.begin(), around.end(), tells)) return places;
  const VoxelSpace s = voxelise(task.embree.scene(), task.bounds, task.params.voxel * task.longest, task.pool, task.progress);
  const std::vector<bool> open = openSpaces(task, s);
  std::vector<vec3> kept;
  for (size_t i = 0; i < places.size(); ++i) {
    const ivec3 v = s.voxelOf(places[i]);
    const uint32_t space = tells(around[i]) || !s.contains(v) ? kSurfaceVoxel : s.space[s.index(v)];
    if (space == kSurfaceVoxel || open[space])
      kept.push_back(places[i]);
    else
      ++out.candidates, ++out.rejectedInside;
  }
  return kept;
}

}  // namespace hl
