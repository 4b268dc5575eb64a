#include <algorithm>
#include <cmath>

#include "engine/scene/scene_file.h"

namespace hl {

namespace {

/// Whether the surfaces look mostly inward: seen from the centre, more area shows its front than its back.
bool looksInward(const Scene& scene) {
  const vec3 centre = scene.bounds.centre();
  double inward = 0, outward = 0;
  for (const uvec3 t : scene.indices) {
    const vec3 p = scene.positions[t.x];
    const vec3 doubled = glm::cross(scene.positions[t.y] - p, scene.positions[t.z] - p);
    const float towards = glm::dot(doubled, centre - p);
    const double area = static_cast<double>(glm::length(doubled));
    (towards > 0 ? inward : outward) += area;
  }
  return inward > outward;
}

}  // namespace

Camera sensibleCamera(const Scene& scene) {
  Camera c;
  c.name = "default";
  c.verticalFov = 45 * kPi / 180;
  if (scene.bounds.empty() || !(scene.bounds.diagonal() > 0)) return c;
  const vec3 size = scene.bounds.max - scene.bounds.min, centre = scene.bounds.centre();
  if (looksInward(scene) && std::min({size.x, size.y, size.z}) > 0.1f * std::max({size.x, size.y, size.z})) {
    // A room: from near one end of its longer side, at eye height, along it.
    const bool alongX = size.x > size.z;
    const vec3 along = alongX ? vec3(0.5f * size.x, 0, 0) : vec3(0, 0, 0.5f * size.z);
    c.position = centre + 0.9f * along;
    c.target = centre - along;
    c.verticalFov = 70 * kPi / 180;
    return c;
  }
  // An object: from the front, the side and above, far enough for its bounding sphere.
  const float radius = 0.5f * scene.bounds.diagonal();
  c.position = centre + glm::normalize(vec3(0.45f, 0.35f, 1.0f)) * (1.05f * radius / std::sin(0.5f * c.verticalFov));
  c.target = centre;
  return c;
}

}  // namespace hl
