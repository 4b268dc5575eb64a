#include "engine/passes/hit_surfaces.h"

#include <array>

#include "engine/core/error.h"
#include "shaders/passes/hit_surfaces.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

namespace hl {

HitSurfaces::HitSurfaces(Device& device, const GpuScene& scene, DirectLight& light) : device_(device), scene_(scene), light_(light) {
  counters_ = device.buffer("hits: counters", 2 * shared::kHitCounters * sizeof(uint32_t));
}

uint64_t HitSurfaces::largestBatch() const { return device_.maxStorageBufferBytes() / sizeof(shared::SurfacePoint); }

void HitSurfaces::reserve(const std::string& prefix, uint32_t count) {
  if (points_ && points_.size() >= uint64_t{count} * sizeof(shared::SurfacePoint)) return;
  if (count > largestBatch())
    throw Error(ErrorKind::TooLarge, prefix + ": " + std::to_string(count) + " hits are more than a buffer of this device holds (" +
                                       std::to_string(largestBatch()) + ")");
  points_ = device_.buffer("hits: points", uint64_t{count} * sizeof(shared::SurfacePoint));
  albedo_ = device_.buffer("hits: albedo", uint64_t{count} * sizeof(vec4));
  direct_ = device_.buffer("hits: direct", uint64_t{count} * sizeof(vec4));
}

void HitSurfaces::record(FrameGraph& graph, const std::string& prefix, const Rays& r) {
  if (r.count == 0) {
    graph.skip(prefix + ": surfaces", "no rays");
    return;
  }
  const uint64_t end = uint64_t{r.first} + r.count;
  if (r.rays.size() < end * sizeof(shared::Ray) || r.hits.size() < end * sizeof(shared::Hit))
    throw badInput(prefix + ": rays [" + std::to_string(r.first) + ", " + std::to_string(end) + ") lie outside buffer " +
                   (r.rays.size() < end * sizeof(shared::Ray) ? r.rays.name() : r.hits.name()));
  reserve(prefix, r.count);
  if (countersStale_) graph.clear(prefix + ": clear counters", counters_);
  countersStale_ = false;
  graph.compute(prefix + ": surfaces", "passes/hit_surfaces.comp")
      .bind("rays", r.rays, Access::Read)
      .bind("hits", r.hits, Access::Read)
      .bind("indices", scene_.indices, Access::Read)
      .bind("positions", scene_.positions, Access::Read)
      .bind("normals", scene_.normals, Access::Read)
      .bind("uvs", scene_.uvs, Access::Read)
      .bind("materials", scene_.materials, Access::Read)
      .bind("material_ids", scene_.materialIds, Access::Read)
      .sample("textures", scene_.textures)
      .bind("points", points_, Access::Write)
      .bind("albedo", albedo_, Access::Write)
      .bind("counters", counters_, Access::ReadWrite)
      .specialize("kTextured", scene_.features.albedoTextures ? 1 : 0)
      .specialize("kNormalMaps", scene_.features.normalMaps ? 1 : 0)
      .push(shared::HitBatch{r.first, r.count, r.offset})
      .dispatchThreads(r.count);
  graph.clear(prefix + ": clear direct", direct_);
  light_.record(graph, prefix, points_, direct_, 0, r.count, r.seed, r.sample);
}

std::vector<std::pair<std::string, double>> HitSurfaces::counters() const {
  std::array<uint32_t, 2 * shared::kHitCounters> words{};
  if (!countersStale_) device_.download(counters_, words.data(), sizeof words);
  const auto value = [&](uint32_t which) { return static_cast<double>(uint64_t{words[2 * which + 1]} << 32 | words[2 * which]); };
  return {{"hits_nothing", value(shared::kCountHitNothing)}, {"hits_back_face", value(shared::kCountHitBackFace)}};
}

std::vector<std::pair<std::string, uint64_t>> HitSurfaces::memory() const {
  uint64_t bytes = counters_.size();
  for (const Buffer* b : {&points_, &albedo_, &direct_}) bytes += *b ? b->size() : 0;
  return {{"surfaces at ray hits", bytes}};
}

}  // namespace hl
