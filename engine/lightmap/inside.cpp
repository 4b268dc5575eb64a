#include "engine/lightmap/inside.h"

#include "engine/scene/back_faces.h"
#include "shaders/shared/sampling.h"

namespace hl {
namespace {
constexpr size_t kGrain = 256;  ///< texels a piece: batches of 8192 rays
}

FindInside insideTest(const Scene& scene, TaskPool& pool, float offset, CastClosest cast) {
  return [&scene, &pool, offset, cast = std::move(cast)](const std::vector<Lumel>& lumels, std::vector<uint8_t>& inside) {
    inside.assign(lumels.size(), 0);
    pool.parallelFor(lumels.size(), kGrain, [&](size_t begin, size_t end, unsigned) {
      std::vector<shared::Ray> rays((end - begin) * kInsideRays);
      std::vector<shared::Hit> hits(rays.size());
      for (size_t i = begin; i < end; ++i) {
        const Lumel& l = lumels[i];
        // Shifted by a hash of the texel: the same few directions everywhere would all miss the same narrow openings.
        const glm::uvec2 shift(shared::pcgHash(l.texel), shared::pcgHash(l.texel ^ 0x9e3779b9u));
        for (uint32_t k = 0; k < kInsideRays; ++k) {
          shared::Ray& ray = rays[(i - begin) * kInsideRays + k];
          ray.origin = l.position + l.normal * offset;
          ray.direction = shared::fromLocal(shared::sampleCosineHemisphere(shared::r2Point(k, shift)), l.normal);
          ray.tMin = 0;
          ray.tMax = 3.4e38f;
        }
      }
      cast(rays, hits);
      for (size_t i = begin; i < end; ++i) {
        int backs = 0;
        for (size_t k = 0; k < kInsideRays; ++k) {
          const size_t at = (i - begin) * kInsideRays + k;
          backs += meetsOneSidedBack(scene, rays[at], hits[at]);
        }
        inside[i] = static_cast<float>(backs) > kInsideBackShare * kInsideRays;
      }
    });
  };
}

}  // namespace hl
