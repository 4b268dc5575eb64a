#include "engine/techniques/ddgi/probes.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/techniques/ddgi/lattice.h"
#include "shaders/shared/random.h"
#include "shaders/shared/ray.h"

namespace hl {
namespace {

/// Rays in flight at most, the same on every device: a hit's random numbers go by its place in the batch.
constexpr uint32_t kBatchRays = 1u << 18;
/// Steps of relocation from the lattice on, each as far as the fixed rays see to be needed: corners take two or three.
constexpr int kRelocationSteps = 4;

uint32_t probesAtOnce(uint32_t rays) { return std::max(1u, kBatchRays / rays); }

}  // namespace

DdgiProbes::DdgiProbes(Gpu& gpu, const SceneView& scene, const DdgiParams& params)
    : device_(gpu.device),
      shaders_(gpu.shaders),
      scene_(scene),
      params_(params),
      grid_(fitLattice(scene.scene.bounds, params)),
      count_(probeCount(grid_)),
      albedo_(meanAlbedo(scene.scene)),
      hitSurfaces_(gpu.device, scene.gpuScene, scene.directLight) {
  std::vector<vec4> places;
  for (uint32_t i = 0; i < count_; ++i) {
    const vec3 p = grid_.first + grid_.spacing * vec3(shared::probeAt(i, grid_.counts));
    places.push_back(vec4(p.x, p.y, p.z, static_cast<float>(shared::kProbeActive)));
  }
  probes_ = device_.buffer("ddgi: probes", places.size() * sizeof(vec4), TexelFormat::RGBA32F);
  device_.upload(probes_, places.data(), places.size() * sizeof(vec4));
  ages_ = device_.buffer("ddgi: ages", count_ * sizeof(uint32_t));
  needed_ = device_.buffer("ddgi: probes near surfaces", count_ * sizeof(uint32_t));
  counters_ = device_.buffer("ddgi: counters", shared::kDdgiCounters * sizeof(uint32_t));
  const int across = static_cast<int>(grid_.tilesAcross), rows = static_cast<int>((count_ + grid_.tilesAcross - 1) / grid_.tilesAcross);
  for (int i = 0; i < 2; ++i) {
    const int e = params.irradiance_texels + 2, d = params.distance_texels + 2;
    irradiance_[i] = device_.image("ddgi: irradiance", {across * e, rows * e, Format::RGBA32F});
    distance_[i] = device_.image("ddgi: distance", {across * d, rows * d, Format::RG32F});
  }
}

void DdgiProbes::restart(const DdgiParams& params) {
  params_ = params;
  clearWanted_ = true;
  hitSurfaces_.resetCounters();
  const auto rays = static_cast<uint32_t>(params.rays);
  const uint64_t light = uint64_t{std::min(count_, probesAtOnce(rays))} * rays;
  const uint64_t placing = uint64_t{std::min(count_, probesAtOnce(shared::kFixedRays))} * shared::kFixedRays;
  const uint64_t most = std::max(light, placing);
  if (rays_ && rays_.size() >= most * sizeof(shared::Ray)) return;
  rays_ = device_.buffer("ddgi: rays", most * sizeof(shared::Ray));
  hits_ = device_.buffer("ddgi: hits", most * sizeof(shared::Hit));
  radiance_ = device_.buffer("ddgi: radiance", most * sizeof(vec4));
}

void DdgiProbes::recordClears(FrameGraph& graph) {
  graph.clear("ddgi: clear counters", counters_);
  counted_ = true;
  if (!clearWanted_) return;
  clearWanted_ = false;
  for (int i = 0; i < 2; ++i) {
    graph.clear("ddgi: clear irradiance", irradiance_[i]);
    graph.clear("ddgi: clear distance", distance_[i]);
  }
  graph.clear("ddgi: clear ages", ages_);
}

void DdgiProbes::recordFixedRays(FrameGraph& graph, const shared::DdgiBatch& batch) {
  graph.compute("ddgi: make fixed rays", "ddgi/make_rays.comp")
      .bind("probes", probes_, Access::Read)
      .bind("rays", rays_, Access::Write)
      .uniform("grid", grid_)
      .uniform("ddgi", params_)
      .push(batch)
      .dispatchThreads(batch.probes * batch.rays);
  scene_.tracer.record(graph, "ddgi: cast fixed rays", rays_, hits_, batch.probes * batch.rays, Query::Closest);
}

void DdgiProbes::recordPlacing(FrameGraph& graph) {
  const char* const passes[] = {"ddgi: make fixed rays", "ddgi: cast fixed rays", "ddgi: relocate", "ddgi: mark cells", "ddgi: classify"};
  const char* reason = !placingWanted_ ? "geometry has not changed" : "relocation and classification are off";
  if (!placingWanted_ || (!params_.relocation && !params_.classification)) {
    for (const char* pass : passes) graph.skip(pass, reason);
    placingWanted_ = false;
    return;
  }
  placingWanted_ = false;
  placedStale_ = true;
  const GpuScene& scene = scene_.gpuScene;
  if (params_.classification) {
    graph.clear("ddgi: clear marks", needed_);
    graph.compute("ddgi: mark cells", "ddgi/mark_cells.comp")
        .bind("indices", scene.indices, Access::Read)
        .bind("positions", scene.positions, Access::Read)
        .bind("needed", needed_, Access::ReadWrite)
        .uniform("grid", grid_)
        .uniform("ddgi", params_)
        .push(scene.triangleCount)
        .dispatchThreads(scene.triangleCount);
  }
  const uint32_t atOnce = probesAtOnce(shared::kFixedRays);
  for (uint32_t first = 0; first < count_; first += atOnce) {
    shared::DdgiBatch batch{};
    batch.firstProbe = first, batch.probes = std::min(atOnce, count_ - first), batch.rays = shared::kFixedRays;
    for (int step = 0; params_.relocation && step < kRelocationSteps; ++step) {
      batch.placing = step == 0 ? shared::kCastingAnew : shared::kCastingFixed;
      recordFixedRays(graph, batch);
      graph.compute("ddgi: relocate", "ddgi/relocate.comp")
          .bind("indices", scene.indices, Access::Read)
          .bind("positions", scene.positions, Access::Read)
          .bind("materials", scene.materials, Access::Read)
          .bind("material_ids", scene.materialIds, Access::Read)
          .bind("rays", rays_, Access::Read)
          .bind("hits", hits_, Access::Read)
          .bind("probes", probes_, Access::ReadWrite)
          .uniform("grid", grid_)
          .uniform("ddgi", params_)
          .push(batch)
          .dispatchThreads(batch.probes);
    }
    if (!params_.classification) continue;
    batch.placing = params_.relocation ? shared::kCastingFixed : shared::kCastingAnew;
    recordFixedRays(graph, batch);
    graph.compute("ddgi: classify", "ddgi/classify.comp")
        .bind("indices", scene.indices, Access::Read)
        .bind("positions", scene.positions, Access::Read)
        .bind("materials", scene.materials, Access::Read)
        .bind("material_ids", scene.materialIds, Access::Read)
        .bind("rays", rays_, Access::Read)
        .bind("hits", hits_, Access::Read)
        .bind("needed", needed_, Access::Read)
        .bind("probes", probes_, Access::ReadWrite)
        .bind("ages", ages_, Access::Write)
        .uniform("ddgi", params_)
        .push(batch)
        .dispatchThreads(batch.probes);
  }
}

void DdgiProbes::bindLookup(ComputePass& pass) const {
  pass.uniform("grid", grid_)
      .uniform("ddgi", params_)
      .bind("probes", probes_, Access::Read)
      .sample("irradianceAtlas", irradiance_[current_])
      .sample("distanceAtlas", distance_[current_]);
}

void DdgiProbes::recordLight(FrameGraph& graph, shared::DdgiBatch batch, uint32_t batchNumber) {
  const uint32_t rays = batch.probes * batch.rays;
  graph.compute("ddgi: make rays", "ddgi/make_rays.comp")
      .bind("probes", probes_, Access::Read)
      .bind("rays", rays_, Access::Write)
      .uniform("grid", grid_)
      .uniform("ddgi", params_)
      .push(batch)
      .dispatchThreads(rays);
  scene_.tracer.record(graph, "ddgi: cast rays", rays_, hits_, rays, Query::Closest);
  HitSurfaces::Rays hits;
  hits.rays = rays_, hits.hits = hits_, hits.count = rays;
  hits.offset = scene_.direct.ray_offset * scene_.gpuScene.diagonal;
  hits.seed = shared::pcgHash(batch.seed ^ shared::pcgHash(batchNumber + 1)), hits.sample = batch.frame;
  hitSurfaces_.record(graph, "ddgi", hits);
  ComputePass shade = graph.compute("ddgi: shade hits", "ddgi/shade.comp");
  bindLookup(shade);
  shade.bind("rays", rays_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("points", hitSurfaces_.points(), Access::Read)
      .bind("albedo", hitSurfaces_.albedo(), Access::Read)
      .bind("direct", hitSurfaces_.direct(), Access::Read)
      .bind("radiance", radiance_, Access::Write)
      .bind("counters", counters_, Access::ReadWrite)
      .push(batch)
      .dispatchThreads(rays);
}

void DdgiProbes::recordBlend(FrameGraph& graph, const shared::DdgiBatch& batch, bool distance) {
  const GpuImage(&atlas)[2] = distance ? distance_ : irradiance_;
  graph.compute(distance ? "ddgi: blend distance" : "ddgi: blend irradiance", distance ? "ddgi/blend_distance.comp" : "ddgi/blend_irradiance.comp")
      .bind("rays", rays_, Access::Read)
      .bind("radiance", radiance_, Access::Read)
      .bind("probes", probes_, Access::Read)
      .bind("ages", ages_, distance ? Access::Read : Access::ReadWrite)
      .bind("before", atlas[current_], Access::Read)
      .bind("after", atlas[1 - current_], Access::Write)
      .bind("counters", counters_, Access::ReadWrite)
      .uniform("grid", grid_)
      .uniform("ddgi", params_)
      .push(batch)
      .dispatch(batch.probes);
}

void DdgiProbes::record(FrameGraph& graph, uint32_t frame, uint32_t seed) {
  recordClears(graph);
  recordPlacing(graph);
  shared::DdgiBatch batch{};
  batch.rays = static_cast<uint32_t>(params_.rays);
  batch.seed = seed, batch.frame = frame;
  batch.placing = shared::kCastingLight;
  batch.startFrames = startFrames(albedo_, params_);
  const uint32_t atOnce = probesAtOnce(batch.rays);
  uint32_t number = 0;
  for (uint32_t first = 0; first < count_; first += atOnce, ++number) {
    batch.firstProbe = first, batch.probes = std::min(atOnce, count_ - first);
    recordLight(graph, batch, number);
    recordBlend(graph, batch, true);
    recordBlend(graph, batch, false);
  }
  current_ = 1 - current_;
}

void DdgiProbes::recordGather(FrameGraph& graph, const GBuffer& g, vec3 viewer, const GpuImage& result) {
  ComputePass pass = graph.compute("ddgi: gather", "ddgi/gather.comp");
  bindLookup(pass);
  pass.bind("position", g.position, Access::Read)
      .bind("normal", g.normal, Access::Read)
      .bind("geometricNormal", g.geometricNormal, Access::Read)
      .bind("ids", g.ids, Access::Read)
      .bind("materials", scene_.gpuScene.materials, Access::Read)
      .bind("result", result, Access::Write)
      .bind("counters", counters_, Access::ReadWrite)
      .push(viewer)
      .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
}

}  // namespace hl
