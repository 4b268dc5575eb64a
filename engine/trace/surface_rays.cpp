#include "engine/trace/surface_rays.h"

#include <algorithm>
#include <cmath>

#include "engine/core/math.h"
#include "shaders/shared/random.h"

namespace hl {
namespace {

/// Points spread over the surface by area.
class SurfacePoints {
 public:
  explicit SurfacePoints(const Scene& scene) : scene_(scene) {
    double sum = 0;
    for (size_t t = 0; t < scene.triangles(); ++t) cumulative_.push_back(sum += 0.5 * glm::length(cross(t)));
  }

  bool empty() const { return cumulative_.empty() || !(cumulative_.back() > 0); }

  struct Point {
    vec3 position, normal;
  };
  Point sample(shared::Random& random) const {
    const double u = shared::randomFloat(random) * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
    const size_t t = std::min(static_cast<size_t>(found - cumulative_.begin()), cumulative_.size() - 1);
    const float root = std::sqrt(shared::randomFloat(random)), v = shared::randomFloat(random);
    const uvec3 i = scene_.indices[t];
    const vec3 p =
        (1 - root) * scene_.positions[i.x] + root * (1 - v) * scene_.positions[i.y] + root * v * scene_.positions[i.z];
    const vec3 n = cross(t);
    const float length = glm::length(n);
    return {p, length > 0 ? n / length : vec3(0, 1, 0)};
  }

 private:
  vec3 cross(size_t t) const {
    const uvec3 i = scene_.indices[t];
    return glm::cross(scene_.positions[i.y] - scene_.positions[i.x], scene_.positions[i.z] - scene_.positions[i.x]);
  }
  const Scene& scene_;
  std::vector<double> cumulative_;
};

}  // namespace

std::vector<shared::Ray> gatherRays(const Scene& scene, uint32_t count, float offset) {
  const SurfacePoints points(scene);
  if (points.empty()) return {};
  std::vector<shared::Ray> rays(count);
  for (uint32_t i = 0; i < count; ++i) {
    shared::Random random = shared::randomInit(1, i, 0);
    const auto p = points.sample(random);
    // A unit sphere's point added to the normal is cosine distributed about it.
    const float z = 1 - 2 * shared::randomFloat(random), phi = 2 * kPi * shared::randomFloat(random);
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    vec3 d = p.normal + vec3(r * std::cos(phi), r * std::sin(phi), z) * 0.999f;
    d = glm::normalize(d);
    rays[i] = {p.position + p.normal * offset, 0, d, 3e38f};
  }
  return rays;
}

std::vector<shared::Ray> visibilityRays(const Scene& scene, uint32_t count, float offset) {
  const SurfacePoints points(scene);
  if (points.empty()) return {};
  std::vector<shared::Ray> rays(count);
  for (uint32_t i = 0; i < count; ++i) {
    shared::Random random = shared::randomInit(2, i, 0);
    const auto from = points.sample(random), to = points.sample(random);
    const float side = glm::dot(from.normal, to.position - from.position) < 0 ? -1.0f : 1.0f;
    const vec3 origin = from.position + from.normal * (side * offset);
    rays[i] = {origin, 0, to.position - origin, 1 - 1e-4f};
  }
  return rays;
}

}  // namespace hl
