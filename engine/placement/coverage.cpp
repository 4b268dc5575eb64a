#include "engine/placement/coverage.h"

#include <algorithm>
#include <atomic>

#include "engine/scene/back_faces.h"
#include "shaders/shared/sampling.h"

namespace hl {
namespace {

constexpr size_t kGrain = 64;

}  // namespace

std::vector<SurfaceSample> sampleSurfaces(const Scene& scene, uint32_t count) {
  std::vector<double> upTo(scene.triangles());
  double area = 0;
  for (uint32_t t = 0; t < scene.triangles(); ++t) upTo[t] = area += 0.5 * static_cast<double>(glm::length(triangleNormal(scene, t)));
  std::vector<SurfaceSample> out;
  if (!(area > 0)) return out;
  out.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    // Equal shares of the area one after the other: each triangle has its due within one sample.
    const double wanted = area * (i + 0.5) / count;
    const auto t = static_cast<uint32_t>(std::min<ptrdiff_t>(std::upper_bound(upTo.begin(), upTo.end(), wanted) - upTo.begin(), static_cast<ptrdiff_t>(upTo.size()) - 1));
    const uvec3 c = scene.indices[t];
    const vec3 a = scene.positions[c.x], ab = scene.positions[c.y] - a, ac = scene.positions[c.z] - a;
    const vec2 w = shared::sampleTriangle(shared::r2Point(i, glm::uvec2(1u << 31)));
    const vec3 n = glm::cross(ab, ac);
    out.push_back({a + w.x * ab + w.y * ac, n / glm::length(n), scene.materials[scene.materialIds[t]].twoSided});
  }
  return out;
}

bool probeSees(const EmbreeScene& embree, vec3 probe, const SurfaceSample& s, float offset) {
  const float side = glm::dot(s.normal, probe - s.position);
  if (!(side > 0) && !(s.twoSided && side < 0)) return false;
  const vec3 to = s.position + s.normal * (side > 0 ? offset : -offset);
  return !embree.occluded({probe, 0, to - probe, 1});
}

double coverageOf(const EmbreeScene& embree, std::span<const vec3> probes, std::span<const SurfaceSample> samples, float offset, TaskPool& pool, Progress& progress) {
  if (samples.empty() || probes.empty()) return 0;
  std::atomic<uint64_t> seen{0};
  pool.parallelFor(samples.size(), kGrain, [&](size_t begin, size_t end, unsigned) {
    std::vector<std::pair<float, uint32_t>> order(probes.size());  // near ones first: they are the likeliest to see it
    uint64_t here = 0;
    for (size_t i = begin; i < end; ++i) {
      progress.check();
      for (uint32_t k = 0; k < probes.size(); ++k) {
        const vec3 d = probes[k] - samples[i].position;
        order[k] = {glm::dot(d, d), k};
      }
      std::sort(order.begin(), order.end());
      here += std::any_of(order.begin(), order.end(), [&](const auto& o) { return probeSees(embree, probes[o.second], samples[i], offset); });
    }
    seen += here;
  });
  return static_cast<double>(seen) / static_cast<double>(samples.size());
}

}  // namespace hl
