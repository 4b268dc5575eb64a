#pragma once
// Rays such as techniques cast, from random points of a scene's surfaces: to measure tracers with.
#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"
#include "shaders/shared/ray.h"

namespace hl {

/// Gathering rays: cosine distributed round the normals of points spread by area. Incoherent, as a bake's are. `offset` [m] in front of the surface. None where the scene has no surface.
std::vector<shared::Ray> gatherRays(const Scene&, uint32_t count, float offset);
/// Visibility rays: from one such point to another.
std::vector<shared::Ray> visibilityRays(const Scene&, uint32_t count, float offset);

}  // namespace hl
