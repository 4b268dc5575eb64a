#include "engine/lightmap/inside.h"

#include <numeric>

#include "engine/scene/back_faces.h"
#include "shaders/shared/sampling.h"

namespace hl {
namespace {
constexpr size_t kGrain = 256;  ///< texels a piece: batches of 4096 rays, and another of those that are not decided by them
}

FindInside insideTest(const Scene& scene, TaskPool& pool, float offset, CastClosest cast) {
  return [&scene, &pool, offset, cast = std::move(cast)](const std::vector<Lumel>& lumels, std::vector<uint8_t>& inside) {
    inside.assign(lumels.size(), 0);
    pool.parallelFor(lumels.size(), kGrain, [&](size_t begin, size_t end, unsigned) {
      // The first rays decide for most: where none of so many meets a back, all that are left could not make it more than the share.
      constexpr auto kFirst = static_cast<uint32_t>((1 - kInsideBackShare) * kInsideRays);
      std::vector<shared::Ray> rays;
      std::vector<shared::Hit> hits;
      std::vector<int> backs(end - begin, 0);
      std::vector<size_t> open(end - begin);
      std::iota(open.begin(), open.end(), begin);
      const auto ask = [&](uint32_t first, uint32_t last) {
        const size_t each = last - first;
        rays.resize(open.size() * each), hits.resize(rays.size());
        for (size_t n = 0; n < open.size(); ++n) {
          const Lumel& l = lumels[open[n]];
          // Shifted by a hash of the texel: the same few directions everywhere would all miss the same narrow openings.
          const glm::uvec2 shift(shared::pcgHash(l.texel), shared::pcgHash(l.texel ^ 0x9e3779b9u));
          for (uint32_t k = first; k < last; ++k) {
            shared::Ray& ray = rays[n * each + k - first];
            ray.origin = l.position + l.normal * offset;
            ray.direction = shared::fromLocal(shared::sampleCosineHemisphere(shared::r2Point(k, shift)), l.normal);
            ray.tMin = 0;
            ray.tMax = 3.4e38f;
          }
        }
        cast(rays, hits);
        for (size_t n = 0; n < open.size(); ++n)
          for (size_t k = 0; k < each; ++k) backs[open[n] - begin] += meetsOneSidedBack(scene, rays[n * each + k], hits[n * each + k]);
      };
      ask(0, kFirst);
      std::erase_if(open, [&](size_t i) { return backs[i - begin] == 0; });
      if (!open.empty()) ask(kFirst, kInsideRays);
      for (size_t i = begin; i < end; ++i) inside[i] = static_cast<float>(backs[i - begin]) > kInsideBackShare * kInsideRays;
    });
  };
}

}  // namespace hl
