#include "engine/techniques/srp/glossy.h"

#include <array>

#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lightmap_codes.h"

namespace hl {

std::vector<uint8_t> wideLumels(const SceneView& scene, const SrpParams& params) {
  const std::vector<Lumel>& lumels = scene.atlas->lumels;
  if (params.receivers == kReceiversDirectional) return std::vector<uint8_t>(lumels.size(), 1);
  if (params.receivers != kReceiversRadiance || !scene.features.glossySurfaces) return {};
  std::vector<uint8_t> wide;
  wide.reserve(lumels.size());
  for (const Lumel& l : lumels) wide.push_back(scene.scene.materials[scene.scene.materialIds[l.triangle]].glossy() ? 1 : 0);
  return wide;
}

Reflection::Reflection(Device& device, const SceneView& scene, const ReceiverClusters& clusters, const LightmapTables& tables) : device_(device) {
  const Atlas& atlas = *scene.atlas;
  std::vector<uint32_t> ofLumel(atlas.lumels.size(), shared::kNoLumel), ofTexel(tables.lumelOfTexel.size(), shared::kNoLumel);
  std::vector<vec3> normals;
  for (const ReceiverCluster& c : clusters.clusters)
    for (uint32_t r = 0; r < c.wide; ++r) {
      const uint32_t lumel = clusters.lumelOfReceiver[c.firstReceiver + r];
      ofLumel[lumel] = static_cast<uint32_t>(normals.size());
      normals.push_back(atlas.lumels[lumel].normal);
    }
  if (normals.empty()) return;
  for (size_t i = 0; i < ofTexel.size(); ++i) {
    if (tables.lumelOfTexel[i] == shared::kNoLumel) continue;
    const uint32_t lumel = tables.lumelOfTexel[i] & ~shared::kBorrowed;
    // A texel past a chart's rim borrows from whichever neighbour comes first, and belongs to a chart where it is next to that alone.
    if (atlas.charts[atlas.lumels[lumel].triangle] == tables.chartOfTexel[i]) ofTexel[i] = ofLumel[lumel];
  }
  glossyOfTexel_ = device_.buffer("srp: glossy receiver of texel", std::span<const uint32_t>(ofTexel));
  normals_ = device_.buffer("srp: normals of glossy receivers", std::span<const vec3>(normals));
  counters_ = device_.buffer("srp: counters of what is reflected", shared::kSrpReflectedCounters * sizeof(uint32_t));
}

void Reflection::record(FrameGraph& graph, const GBuffer& g, const Camera& camera, const LightmapImages& lightmap, const Buffer& incident, const SrpParams& params, const GpuImage& to) {
  graph.clear("srp: clear counters of what is reflected", counters_);
  counted_ = true;
  graph.compute("srp: reflect", "srp/reflect.comp")
      .bind("position", g.position, Access::Read)
      .bind("normal", g.normal, Access::Read)
      .bind("geometricNormal", g.geometricNormal, Access::Read)
      .bind("specular", g.specular, Access::Read)
      .bind("ids", g.ids, Access::Read)
      .bind("chartOfTriangle", lightmap.chartOfTriangle(), Access::Read)
      .bind("chartOfTexel", lightmap.chartOfTexel(), Access::Read)
      .bind("glossyOfTexel", glossyOfTexel_, Access::Read)
      .bind("normals", normals_, Access::Read)
      .bind("incident", incident, Access::Read)
      .bind("result", to, Access::Write)
      .bind("counters", counters_, Access::ReadWrite)
      .specialize("kDegree", static_cast<uint32_t>(params.glossy_order))
      .push(shared::SrpReflect{camera.position, static_cast<uint32_t>(params.glossy_samples), params.clamp_negative != 0 ? 1u : 0u})
      .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
}

Reflection::Counts Reflection::counts() const {
  std::array<uint32_t, shared::kSrpReflectedCounters> counts{};
  if (counted_) device_.download(counters_, counts.data(), sizeof counts);
  return {counts[shared::kSrpReflectedNegative], counts[shared::kSrpReflectedNonFinite], counts[shared::kSrpReflectedNoTexel]};
}

}  // namespace hl
