#pragma once
// What probes see of the surfaces.
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/trace/embree_scene.h"

namespace hl {

struct SurfaceSample {
  vec3 position{0.0f}, normal{0.0f};
  bool twoSided = false;
};

/// `count` points spread evenly by area: the same for the same triangles. Empty for a scene without any of some area.
std::vector<SurfaceSample> sampleSurfaces(const Scene&, uint32_t count);

/// Whether a probe sees the point: in front of it (either side of a two-sided one), and nothing between. `offset` [m]: how far from the surface rays end.
bool probeSees(const EmbreeScene&, vec3 probe, const SurfaceSample&, float offset);

/// Share of the samples that at least one probe sees; 0 for none.
double coverageOf(const EmbreeScene&, std::span<const vec3> probes, std::span<const SurfaceSample>, float offset, TaskPool&, Progress&);

}  // namespace hl
