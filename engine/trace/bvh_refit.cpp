#include "engine/trace/bvh_refit.h"

#include <algorithm>
#include <bit>

namespace hl {
namespace {

struct Walk {
  const Bvh& bvh;
  const std::vector<bool>& moving;
  BvhRefit& out;
  std::vector<std::vector<uint32_t>> levels;

  vec4 texel(uint32_t node, uint32_t t) const { return bvh.nodes[size_t{node} * kBvhNodeTexels + t]; }

  double halfArea(uint32_t node, int child) const {
    vec3 e;
    for (uint32_t axis = 0; axis < 3; ++axis) e[static_cast<int>(axis)] = texel(node, 2 * axis + 1)[child] - texel(node, 2 * axis)[child];
    return static_cast<double>(e.x * e.y + e.y * e.z + e.z * e.x);
  }

  /// The level of the node, or -1 where nothing under it moves.
  int visit(uint32_t node) {
    int level = -1;
    double area = 0;
    for (int c = 0; c < 4; ++c) {
      if (texel(node, 0)[c] > texel(node, 1)[c]) continue;  // an unused slot
      const auto word = std::bit_cast<uint32_t>(texel(node, 6)[c]);
      if (word & kBvhLeafBit) {
        const uint32_t first = word & kBvhFirstMask, count = (word >> kBvhCountShift & 7u) + 1;
        area += halfArea(node, c) * count;
        for (uint32_t i = first; i < first + count; ++i) {
          const uint32_t triangle = std::bit_cast<uint32_t>(bvh.triangles[size_t{i} * kBvhTriangleTexels].w) & kBvhNodeMask;
          if (!moving[triangle]) continue;
          out.triangles.push_back(i);
          level = std::max(level, 0);
        }
      } else {
        area += halfArea(node, c);
        const int below = visit(word & kBvhNodeMask);
        if (below >= 0) level = std::max(level, below + 1);
      }
    }
    if (level < 0) {
      out.restArea += area;
      return -1;
    }
    if (levels.size() <= static_cast<size_t>(level)) levels.resize(static_cast<size_t>(level) + 1);
    levels[static_cast<size_t>(level)].push_back(node);
    return level;
  }
};

}  // namespace

BvhRefit planRefit(const Bvh& bvh, const std::vector<bool>& moving) {
  BvhRefit out;
  out.builtCost = bvh.cost;
  if (moving.empty() || bvh.triangles.empty()) return out;
  Walk walk{bvh, moving, out, {}};
  walk.visit(0);
  for (const std::vector<uint32_t>& level : walk.levels) {
    out.nodes.insert(out.nodes.end(), level.begin(), level.end());
    out.levels.push_back(static_cast<uint32_t>(out.nodes.size()));
  }
  std::sort(out.triangles.begin(), out.triangles.end());
  return out;
}

double costAfterRefit(const BvhRefit& refit, std::span<const float> areas, float rootArea) {
  double sum = refit.restArea;
  for (const float a : areas) sum += static_cast<double>(a);
  return rootArea > 0 ? sum / static_cast<double>(rootArea) : refit.builtCost;
}

}  // namespace hl
