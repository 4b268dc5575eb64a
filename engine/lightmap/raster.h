#pragma once
// Which sample points a 2D triangle owns. Two triangles that share an edge never both own a point and never leave one out, because the edge is
// evaluated in the same order of its ends, and so to the same bits, for both.
#include <glm/vec2.hpp>

namespace hl {

/// A triangle's three edges, ready for ownership tests. Either winding; one without area owns nothing.
class OwnershipTest {
 public:
  OwnershipTest(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);
  bool owns(glm::dvec2 p) const;
  bool degenerate() const { return degenerate_; }

 private:
  struct Edge {
    glm::dvec2 from, direction;
    bool flipped;  ///< the inside is where the edge function is negative
  };
  Edge edges_[3];
  bool degenerate_ = false;
};

}  // namespace hl
