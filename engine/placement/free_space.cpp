#include "engine/placement/free_space.h"

#include "engine/scene/back_faces.h"
#include "shaders/shared/sampling.h"

namespace hl {
namespace {

constexpr size_t kGrain = 64;
constexpr glm::uvec2 kShift(1u << 31);  ///< no ray along an axis, in the plane of a wall
/// A place in a surface itself, as a share of the distance wanted: which side it is on is then a matter of rounding.
constexpr float kOnSurface = 1e-3f;
/// What rounding may take off a distance that was made.
constexpr float kSlack = 1e-4f;

}  // namespace

std::vector<Surroundings> lookAround(const EmbreeScene& embree, std::span<const vec3> places, TaskPool& pool, Progress& progress) {
  std::vector<Surroundings> out(places.size());
  const Scene& scene = embree.scene();
  pool.parallelFor(places.size(), kGrain, [&](size_t begin, size_t end, unsigned) {
    std::vector<shared::Ray> rays(kSurroundingRays);
    std::vector<shared::Hit> hits(kSurroundingRays);
    for (size_t i = begin; i < end; ++i) {
      progress.check();
      for (uint32_t k = 0; k < kSurroundingRays; ++k)
        rays[k] = {places[i], 0, shared::sampleUniformSphere(shared::r2Point(k, kShift)), 3.4e38f};
      embree.closest(rays, hits);
      uint32_t backs = 0, fronts = 0;
      for (uint32_t k = 0; k < kSurroundingRays; ++k) {
        if (hits[k].primitive == shared::kMiss || scene.materials[scene.materialIds[hits[k].primitive]].twoSided) continue;
        ++(meetsOneSidedBack(scene, rays[k], hits[k]) ? backs : fronts);
      }
      out[i] = {static_cast<float>(backs) / kSurroundingRays, static_cast<float>(fronts) / kSurroundingRays};
    }
  });
  return out;
}

Cleared clearOfSurfaces(const EmbreeScene& embree, vec3 place, float distance) {
  if (!(distance > 0)) return {place, false, true};
  const NearestPoint near = embree.nearest(place, distance);
  if (near.triangle == kNone) return {place, false, true};
  const vec3 normal = triangleNormal(embree.scene(), near.triangle);
  const float length = glm::length(normal);
  if (!(length > 0)) return {place, false, false};
  const vec3 away = near.distance > kOnSurface * distance ? (place - near.position) / near.distance : normal / length;
  const vec3 there = near.position + away * distance;
  return {there, true, embree.nearest(there, distance * (1 - kSlack)).triangle == kNone};
}

}  // namespace hl
