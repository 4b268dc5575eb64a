#include "engine/placement/voxels.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hl {
namespace {

constexpr double kMostVoxels = 1u << 26;
constexpr size_t kGrain = 1024;
const ivec3 kFaces[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

/// Whether a triangle (corners relative to the cube's middle) meets a cube of half side `h` (Akenine-Moeller 2001). Touching counts.
bool meetsCube(const vec3 (&v)[3], float h) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::min({v[0][axis], v[1][axis], v[2][axis]}) > h || std::max({v[0][axis], v[1][axis], v[2][axis]}) < -h) return false;
  const vec3 edges[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  const vec3 n = glm::cross(edges[0], edges[1]);
  if (std::abs(glm::dot(n, v[0])) > h * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z))) return false;
  for (const vec3 e : edges) {
    const vec3 axes[3] = {{0, -e.z, e.y}, {e.z, 0, -e.x}, {-e.y, e.x, 0}};
    for (const vec3 a : axes) {
      const float p0 = glm::dot(a, v[0]), p1 = glm::dot(a, v[1]), p2 = glm::dot(a, v[2]);
      const float r = h * (std::abs(a.x) + std::abs(a.y) + std::abs(a.z));
      if (std::min({p0, p1, p2}) > r || std::max({p0, p1, p2}) < -r) return false;
    }
  }
  return true;
}

}  // namespace

ivec3 VoxelSpace::at(size_t i) const {
  const auto x = static_cast<size_t>(counts.x), y = static_cast<size_t>(counts.y);
  return {static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / (x * y))};
}

bool VoxelSpace::nextToSurface(ivec3 v) const {
  return std::any_of(std::begin(kFaces), std::end(kFaces), [&](ivec3 f) { return contains(v + f) && space[index(v + f)] == kSurfaceVoxel; });
}

VoxelSpace voxelise(const Scene& scene, const Bounds& bounds, float side, TaskPool& pool, Progress& progress) {
  VoxelSpace s;
  s.side = side;
  double total = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const float length = bounds.max[axis] - bounds.min[axis];
    s.counts[axis] = std::max(1, static_cast<int>(std::ceil(length / side))) + 2;
    s.origin[axis] = 0.5f * (bounds.min[axis] + bounds.max[axis] - static_cast<float>(s.counts[axis]) * side);
    total *= s.counts[axis];
  }
  if (total > kMostVoxels)
    throw Error(ErrorKind::TooLarge, fmt::format("probes: {} x {} x {} voxels are more than 2^26; raise probes.voxel", s.counts.x, s.counts.y, s.counts.z));
  std::vector<std::atomic<uint8_t>> solid(static_cast<size_t>(total));
  pool.parallelFor(scene.triangles(), kGrain, [&](size_t begin, size_t end, unsigned) {
    progress.check();
    for (size_t t = begin; t < end; ++t) {
      const uvec3 c = scene.indices[t];
      const vec3 p[3] = {scene.positions[c.x], scene.positions[c.y], scene.positions[c.z]};
      const ivec3 low = glm::clamp(s.voxelOf(glm::min(p[0], glm::min(p[1], p[2]))), ivec3(0), s.counts - 1);
      const ivec3 high = glm::clamp(s.voxelOf(glm::max(p[0], glm::max(p[1], p[2]))), ivec3(0), s.counts - 1);
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x) {
            const vec3 m = s.centre({x, y, z});
            // Relative to the voxel, so that far from the origin no figures are lost; a shade larger, so that rounding opens no hole.
            const vec3 v[3] = {p[0] - m, p[1] - m, p[2] - m};
            if (meetsCube(v, 0.5f * side * 1.0001f)) solid[s.index({x, y, z})].store(1, std::memory_order_relaxed);
          }
    }
  });
  // Empty spaces, flooded one after the other from their first voxel.
  constexpr uint32_t kUnknown = kSurfaceVoxel - 1;
  s.space.resize(solid.size());
  for (size_t i = 0; i < solid.size(); ++i) s.space[i] = solid[i].load(std::memory_order_relaxed) ? kSurfaceVoxel : kUnknown;
  std::vector<size_t> open;
  for (size_t i = 0; i < s.space.size(); ++i) {
    if (s.space[i] != kUnknown) continue;
    s.space[i] = s.spaces;
    open.assign(1, i);
    while (!open.empty()) {
      const ivec3 v = s.at(open.back());
      open.pop_back();
      for (const ivec3 f : kFaces) {
        if (!s.contains(v + f)) continue;
        const size_t next = s.index(v + f);
        if (s.space[next] != kUnknown) continue;
        s.space[next] = s.spaces;
        open.push_back(next);
      }
    }
    ++s.spaces;
    progress.check();
  }
  return s;
}

}  // namespace hl
