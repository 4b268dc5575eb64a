#pragma once
// What lies round places in space: whether they are inside geometry, and how far the next surface is.
#include <span>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/trace/embree_scene.h"

namespace hl {

/// Rays by which a place is judged, spread evenly over all directions.
inline constexpr uint32_t kSurroundingRays = 128;

struct Surroundings {
  float backs = 0;    ///< share of rays that meet the back of a one-sided surface
  float fronts = 0;   ///< ... the front of one; what is left meets two-sided surfaces, or nothing
};

/// One a place, all by the same directions: what is found depends neither on the order of places nor on the scene's size.
std::vector<Surroundings> lookAround(const EmbreeScene&, std::span<const vec3> places, TaskPool&, Progress&);

/// The place, or one at `distance` [m] from the nearest surface, on the side that it is on, or in front where it lies in the surface itself.
/// `moved` says which.
struct Cleared {
  vec3 position{0.0f};
  bool moved = false, clear = true;  ///< not clear: other surfaces are too near there
};
Cleared clearOfSurfaces(const EmbreeScene&, vec3 place, float distance);

}  // namespace hl
