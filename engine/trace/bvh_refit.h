#pragma once
// What of a tree has to follow when some of its triangles move, and how good the tree still is then.
#include <cstdint>
#include <span>
#include <vector>

#include "engine/trace/bvh.h"

namespace hl {

/// A tree is built anew once a random ray is expected to make this many times the tests in it that it made when it was built.
inline constexpr double kBvhWorn = 1.5;

struct BvhRefit {
  std::vector<uint32_t> triangles;  ///< those that move, in leaf order
  std::vector<uint32_t> nodes;      ///< those above them, children before their parents: level 0 has only leaves that move, ...
  std::vector<uint32_t> levels;     ///< where in `nodes` each level ends
  double restArea = 0;              ///< half area times tests, summed over the nodes that stay: what does not change in Bvh::cost
  double builtCost = 0;             ///< Bvh::cost
};

/// `moving`: one flag a scene triangle.
BvhRefit planRefit(const Bvh&, const std::vector<bool>& moving);

/// The tree's cost now, by what each of `nodes` adds (half area of each child's box times its tests, as shaders/bvh/refit.comp writes it) and half the area
/// of the root's box.
double costAfterRefit(const BvhRefit&, std::span<const float> areas, float rootArea);

}  // namespace hl
