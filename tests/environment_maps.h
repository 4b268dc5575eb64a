#pragma once
// Environment maps made on the spot.
#include <functional>

#include "engine/scene/scene.h"

namespace hl::test {

inline Environment mapOf(int width, int height, const std::function<vec3(int x, int y)>& f) {
  Environment e;
  e.width = width, e.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) e.radiance.push_back(f(x, y));
  return e;
}

}  // namespace hl::test
