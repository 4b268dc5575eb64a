#include "engine/lightmap/raster.h"

#include <utility>

namespace hl {

OwnershipTest::OwnershipTest(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  const double area2 = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  degenerate_ = !(area2 != 0.0);
  const glm::dvec2 corners[3] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    glm::dvec2 from = corners[i], to = corners[(i + 1) % 3];
    bool flipped = area2 < 0;
    if (to.x < from.x || (to.x == from.x && to.y < from.y)) {
      std::swap(from, to);
      flipped = !flipped;
    }
    edges_[i] = {from, to - from, flipped};
  }
}

bool OwnershipTest::owns(glm::dvec2 p) const {
  if (degenerate_) return false;
  for (const Edge& e : edges_) {
    const double side = e.direction.x * (p.y - e.from.y) - e.direction.y * (p.x - e.from.x);
    // A point on the edge itself counts as on its positive side, for both neighbours.
    if ((side >= 0) == e.flipped) return false;
  }
  return true;
}

}  // namespace hl
