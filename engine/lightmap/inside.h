#pragma once
// Does a texel lie inside other geometry (a floor under a box)? Asked with rays: inside a closed one-sided object most of them meet its back.
#include <functional>
#include <span>
#include <vector>

#include "engine/core/task_pool.h"
#include "engine/lightmap/atlas.h"
#include "engine/scene/scene.h"
#include "shaders/shared/ray.h"

namespace hl {

inline constexpr int kInsideRays = 32;          ///< a texel, cosine distributed
inline constexpr float kInsideBackShare = 0.5f;  ///< share of rays that must meet a back for the texel to count as inside

inline constexpr float kInsideRayOffset = 1e-5f; ///< how far in front of the surface they start, as a share of the scene's diagonal

/// The closest hits of a batch of rays, called from several threads.
using CastClosest = std::function<void(std::span<const shared::Ray>, std::span<shared::Hit>)>;

/// The test for buildAtlas. `offset` [m]: how far in front of the surface rays start. Keeps references to `scene` and `pool`.
/// The back of a two-sided material does not count: one may stand behind a leaf.
FindInside insideTest(const Scene& scene, TaskPool& pool, float offset, CastClosest cast);

}  // namespace hl
