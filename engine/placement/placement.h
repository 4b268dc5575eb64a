#pragma once
// Where probes stand (TECHNIQUES.md section 6): manual, a grid, or found from the scene. On the host, so that every device gets the same.
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/params/groups.h"
#include "engine/scene/scene.h"
#include "engine/trace/embree_scene.h"

namespace hl {

/// No placement makes more.
inline constexpr uint64_t kMostPlacedProbes = 1u << 16;

struct PlacedProbes {
  std::vector<vec3> positions;       ///< [m]
  std::vector<uint8_t> inside;       ///< one a probe: it stands inside geometry, which a manual one alone can
  double coverage = 0;               ///< share of the surfaces' area that at least one probe sees, from the front where they are one-sided
  uint64_t candidates = 0;           ///< places that were looked at
  uint64_t rejectedInside = 0;       ///< ... and left out: inside geometry
  uint64_t rejectedNear = 0;         ///< ... too near to a surface, and not to be moved away
  uint64_t moved = 0;                ///< moved away from a surface
  uint64_t merged = 0;               ///< left out since another one close by sees as much
  uint64_t insideGeometry = 0;       ///< of `inside`
  double seconds = 0;                ///< that it took
  std::vector<std::string> warnings; ///< lines for the person: manual probes inside geometry, by number and place

  size_t count() const { return positions.size(); }
};

/// By `params.placement`, in the scene as it stands now, whose rays are `embree`'s. The same on every machine for the same scene and parameters. A scene without
/// surfaces has none.
/// @throws Error(BadInput) where there is nothing to place: no manual probes, or all candidates inside geometry. @throws Error(TooLarge) above
/// kMostPlacedProbes. @throws Error(Cancelled)
PlacedProbes placeProbes(const ProbesParams& params, const Scene& scene, const EmbreeScene& embree, TaskPool& pool, Progress& progress);

}  // namespace hl
