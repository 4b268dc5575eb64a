// What a bake holds, for reports: memory, counters, and the samples of a texel that somebody picked.
#include <fmt/format.h>

#include <array>

#include "engine/techniques/radiosity/bake.h"
#include "engine/techniques/radiosity/unit.h"
#include "shaders/shared/ray.h"

namespace hl {

std::vector<MemoryItem> RadiosityBake::memory() const {
  std::vector<MemoryItem> items;
  const auto add = [&](const char* name, std::initializer_list<Buffer> buffers) {
    uint64_t bytes = 0;
    for (const Buffer& b : buffers) bytes += b ? b.size() : 0;
    items.push_back({name, bytes});
  };
  add("lumels", {points_, reflectance_, direct_, irradiance_, radiance_});
  add("triangles", {triangles_});
  add("directions", {directions_});
  add("rays of a unit", {rays_, hits_, codes_});
  if (host_) items.push_back({"tables on the host", host_->bytes()});
  uint64_t cache = 0;
  for (const Buffer& b : cache_) cache += b.size();
  items.push_back({"hit cache", cache});
  if (images_)
    for (auto& [name, bytes] : images_->memory()) items.push_back({name, bytes});
  if (directImage_) items.push_back({"direct lightmap", uint64_t{16} * resolution_ * resolution_});
  return items;
}

std::vector<std::pair<std::string, double>> RadiosityBake::counters() const {
  const AtlasReport& report = scene_.atlas->report;
  std::vector<std::pair<std::string, double>> list = {{"lumels", lumels_},
                                                      {"invalid_texels", static_cast<double>(report.insideTexels)},
                                                      {"opened_texels", static_cast<double>(report.openedTexels)},
                                                      {"overlapping_texels", static_cast<double>(report.overlappingTexels)},
                                                      {"uncovered_area", report.uncoveredArea},
                                                      {"rays_cast", workDone_.rays},
                                                      {"bounces", bounce_},
                                                      {"residual", outcome_->residual}};
  std::array<uint32_t, 2 * shared::kCounters> words{};
  if (lumels_ > 0 && !clearWanted_) device_.download(counters_, words.data(), sizeof words);
  const auto value = [&](uint32_t which) { return static_cast<double>(uint64_t{words[2 * which + 1]} << 32 | words[2 * which]); };
  list.push_back({"back_face_hits", value(shared::kCountBackFace)});
  list.push_back({"hits_without_texel", value(shared::kCountNoTexel)});
  list.push_back({"lightmap_nan_inf", value(shared::kCountNonFinite)});
  return list;
}

PickReport RadiosityBake::pick(uint32_t lumel) {
  const Lumel& l = scene_.atlas->lumels[lumel];
  const auto samples = static_cast<uint32_t>(params_.samples);
  std::vector<shared::Ray> rays(samples);
  std::vector<shared::Hit> hits(samples);
  std::vector<uint32_t> codes(samples);
  std::vector<vec4> radiance(lumels_), directions(samples);
  vec4 direct, irradiance;
  if (host_) {
    host_->inspect({lumel, 1, 0, scene_.seed, resolution_, 0}, rays, hits, codes);
  } else {
    // In a graph of its own, into the buffers of a unit: between units they hold nothing that is still wanted.
    FrameGraph graph(device_, shaders_);
    recordCast(graph, {lumel, 1, false, false}, codes_, 0);
    graph.execute();
    device_.download(rays_, rays.data(), samples * sizeof(shared::Ray));
    device_.download(hits_, hits.data(), samples * sizeof(shared::Hit));
    device_.download(codes_, codes.data(), samples * sizeof(uint32_t));
  }
  device_.download(directions_, directions.data(), samples * sizeof(vec4));
  device_.download(radiance_, radiance.data(), radiance.size() * sizeof(vec4));
  device_.download(direct_, &direct, sizeof direct, lumel * sizeof(vec4));
  device_.download(irradiance_, &irradiance, sizeof irradiance, lumel * sizeof(vec4));

  PickReport report;
  uint32_t misses = 0, backFaces = 0, withoutTexel = 0;
  for (uint32_t j = 0; j < samples; ++j) {
    misses += codes[j] == shared::kCodeMiss;
    backFaces += codes[j] == shared::kCodeBackFace;
    withoutTexel += codes[j] == shared::kCodeNoTexel;
    const bool missed = codes[j] == shared::kCodeMiss;
    PickSample s;
    s.from = rays[j].origin;
    s.to = rays[j].origin + rays[j].direction * (missed ? 0.25f * scene_.gpuScene.diagonal : hits[j].t);
    if (codes[j] < shared::kFirstCode) s.radiance = vec3(radiance[codes[j]].x, radiance[codes[j]].y, radiance[codes[j]].z);
    s.weight = directions[j].z;
    report.samples.push_back(s);
  }
  const auto colour = [](vec3 c) { return fmt::format("{:.4g}, {:.4g}, {:.4g}", c.x, c.y, c.z); };
  report.facts = {
      {"texel", fmt::format("({}, {})", l.texel % resolution_, l.texel / resolution_)},
      {"lumel", fmt::format("{} of {}", lumel, lumels_)},
      {"area", fmt::format("{:.4g} m^2", l.area)},
      {"albedo", colour(l.albedo)},
      {"direct irradiance", colour(direct.w > 0 ? vec3(direct.x, direct.y, direct.z) / direct.w : vec3(0.0f))},
      {"indirect irradiance", colour(vec3(irradiance.x, irradiance.y, irradiance.z))},
      {"rays", fmt::format("{}", samples)},
      {"rays into the open", fmt::format("{}", misses)},
      {"rays to back faces", fmt::format("{}", backFaces)},
      {"rays to surfaces without a texel", fmt::format("{}", withoutTexel)},
  };
  return report;
}

}  // namespace hl
