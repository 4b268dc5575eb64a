#pragma once
// The scene as voxels: which hold surface, and how what is left hangs together.
#include <cstdint>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/scene/scene.h"

namespace hl {

/// What a voxel belongs to: surface, or the empty space of that number.
inline constexpr uint32_t kSurfaceVoxel = 0xffffffffu;

struct VoxelSpace {
  ivec3 counts{0};
  vec3 origin{0.0f};              ///< corner of the first voxel [m]
  float side = 0;                 ///< of a voxel [m]
  std::vector<uint32_t> space;    ///< by voxel, x fastest: kSurfaceVoxel, or the number of the empty space that it is part of
  uint32_t spaces = 0;            ///< how many: voxels are of one where they share faces

  size_t index(ivec3 v) const { return (static_cast<size_t>(v.z) * static_cast<size_t>(counts.y) + static_cast<size_t>(v.y)) * static_cast<size_t>(counts.x) + static_cast<size_t>(v.x); }
  bool contains(ivec3 v) const { return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < counts.x && v.y < counts.y && v.z < counts.z; }
  ivec3 voxelOf(vec3 p) const { return ivec3(glm::floor((p - origin) / side)); }
  ivec3 at(size_t i) const;
  vec3 centre(ivec3 v) const { return origin + (vec3(v) + 0.5f) * side; }
  /// Whether it holds surface, or shares a face with one that does.
  bool nextToSurface(ivec3) const;
};

/// Voxels of `side` over the bounds and one more layer round them: a voxel holds surface where it overlaps a triangle (separating axes, so that none slips through).
/// @throws Error(TooLarge) above 2^26 voxels. @throws Error(Cancelled)
VoxelSpace voxelise(const Scene&, const Bounds&, float side, TaskPool&, Progress&);

}  // namespace hl
