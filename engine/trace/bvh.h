#pragma once
// A four-wide bounding volume hierarchy over a scene's triangles, laid out as the texels that the compute shaders read (shaders/bvh/traverse.glsl).
#include <cstdint>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/scene/scene.h"

namespace hl {

inline constexpr uint32_t kBvhNodeTexels = 7, kBvhTriangleTexels = 3;
inline constexpr uint32_t kBvhMaxLeaf = 4;
/// Bits carried in a texel's float have this one set, so that no device takes them for a denormal or a NaN.
inline constexpr uint32_t kBvhPayloadBit = 0x40000000u, kBvhLeafBit = 0x80000000u;
/// A leaf's child word: leaf bit, payload bit, count - 1 (3 bits), first triangle (26 bits). An inner child's: payload bit, node (29 bits).
inline constexpr uint32_t kBvhCountShift = 26, kBvhFirstMask = (1u << 26) - 1, kBvhNodeMask = (1u << 29) - 1;

struct Bvh {
  std::vector<vec4> nodes;      ///< 7 a node: min x of the 4 children, max x, min y, max y, min z, max z, children. Node 0 is the root.
  std::vector<vec4> triangles;  ///< 3 a triangle, in leaf order: (p0, scene triangle), (p1, 1 where alpha-tested), (p2, 0)
  uint32_t stackSize = 1;       ///< entries that a depth-first walk needs at most, one of them for a store that may not count
  double cost = 0;              ///< surface area heuristic: expected node and triangle tests a random ray makes through the root's box
};

/// Binned surface area heuristic. The same scene gives the same tree, whatever the number of threads. Triangles with vertices that are not
/// finite are left out. `alphaTested`: one flag a triangle, or empty.
/// @throws Error(BadInput) beyond 2^26 triangles. @throws Error(Cancelled)
Bvh buildBvh(const Scene&, const std::vector<bool>& alphaTested, TaskPool&, Progress* = nullptr);

}  // namespace hl
