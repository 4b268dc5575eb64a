#include "engine/techniques/radiosity/bake.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/techniques/radiosity/directions.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"

namespace hl {
namespace {

/// What a unit does: some 30 ms on two cores in a large scene; some milliseconds on a GPU, where a unit that is too small is all submission.
struct UnitSize {
  uint32_t rays;        ///< cast
  uint32_t cached;      ///< remembered rays that are read back
  uint32_t lumels;      ///< at most, however few samples each has
  uint32_t directRays;  ///< shadow rays cast
};
constexpr UnitSize kUnitOnCpu{1u << 17, 1u << 21, 1u << 15, 1u << 17}, kUnitOnGpu{1u << 22, 1u << 26, 1u << 20, 1u << 21};

UnitSize unitSize(const Device& device) { return device.isCpu() ? kUnitOnCpu : kUnitOnGpu; }

uint32_t groups(uint32_t n, uint32_t size) { return (n + size - 1) / size; }

}  // namespace

RadiosityBake::RadiosityBake(Gpu& gpu, const SceneView& scene, const RadiosityParams& params, Progress& progress)
    : device_(gpu.device), shaders_(gpu.shaders), scene_(scene), params_(params) {
  const Atlas& atlas = *scene.atlas;
  lumels_ = static_cast<uint32_t>(atlas.lumels.size());
  resolution_ = static_cast<uint32_t>(atlas.resolution);
  if (lumels_ == 0) return;
  const auto samples = static_cast<uint32_t>(params.samples);
  // Elsewhere the host would have to be given a copy of the whole cache.
  const bool onHost = scene.tracer.onHost() && device_.isCpu();
  const UnitSize unit = unitSize(device_);
  // The device's largest buffer bounds a batch as well.
  const auto largest = static_cast<uint32_t>(std::min<uint64_t>(unit.rays, device_.maxStorageBufferBytes() / sizeof(shared::Ray)));
  castLumels_ = std::clamp(largest / samples, 1u, unit.lumels);
  cachedLumels_ = std::clamp(unit.cached / samples, 1u, unit.lumels);
  checkSize("radiosity: lumels", lumels_ * sizeof(shared::SurfacePoint));
  if (!onHost && 2 * scene.scene.triangles() > device_.maxTexelBufferElements())
    throw Error(ErrorKind::TooLarge, "radiosity: " + std::to_string(scene.scene.triangles()) + " triangles are more than this device's texel buffers hold (" +
                                       std::to_string(device_.maxTexelBufferElements() / 2) + ")");

  LightmapTables tables = makeLightmapTables(scene.scene, atlas, scene.lightmap.dilation, progress);
  reflectance_ = device_.buffer("radiosity: reflectance", std::span<const vec4>(tables.reflectance));
  images_ = std::make_unique<LightmapImages>(device_, "radiosity", atlas, tables, scene.lightmap.dilation);
  const std::vector<vec4> directions = makeDirections(progress);
  directions_ = device_.buffer("radiosity: directions", directions.size() * sizeof(vec4), TexelFormat::RGBA32F);
  device_.upload(directions_, directions.data(), directions.size() * sizeof(vec4));

  points_ = device_.buffer("radiosity: lumels", lumels_ * sizeof(shared::SurfacePoint));
  direct_ = device_.buffer("radiosity: direct", lumels_ * sizeof(vec4));
  irradiance_ = device_.buffer("radiosity: irradiance", lumels_ * sizeof(vec4));
  radiance_ = device_.buffer("radiosity: radiance", lumels_ * sizeof(vec4), TexelFormat::RGBA32F);
  counters_ = device_.buffer("radiosity: counters", 2 * shared::kCounters * sizeof(uint32_t));
  const uint64_t unitRays = uint64_t{castLumels_} * samples;
  if (onHost) {
    host_ = std::make_shared<HostUnits>(scene.tracer, scene.pool, params, tables.triangles, std::move(tables.lumelOfTexel), directions);
  } else {
    triangles_ = device_.buffer("radiosity: triangles", tables.triangles.size() * sizeof(vec4), TexelFormat::RGBA32F);
    device_.upload(triangles_, tables.triangles.data(), tables.triangles.size() * sizeof(vec4));
    rays_ = device_.buffer("radiosity: rays", unitRays * sizeof(shared::Ray), TexelFormat::RGBA32F);
    hits_ = device_.buffer("radiosity: hits", unitRays * sizeof(shared::Hit));
  }
  codes_ = device_.buffer("radiosity: codes", unitRays * sizeof(uint32_t));
  allocateCache();
  directImage_ = images_->image("direct lightmap");
  restart(params);
}

void RadiosityBake::checkSize(const char* what, uint64_t bytes) const {
  if (bytes <= device_.maxStorageBufferBytes()) return;
  throw Error(ErrorKind::TooLarge, std::string(what) + ": " + std::to_string(bytes) + " bytes are more than a buffer of this device holds (" +
                                     std::to_string(device_.maxStorageBufferBytes()) + "); lower lightmap.resolution");
}

std::vector<vec4> RadiosityBake::makeDirections(Progress& progress) {
  const auto samples = static_cast<uint32_t>(params_.samples);
  std::vector<vec4> directions;
  directions.reserve(samples);
  if (params_.directions == kDirectionsLargestEmptyCircle) {
    for (const DiscDirection& d : largestEmptyCircles(samples, params_.unweighted != 0, &progress))
      directions.push_back(vec4(static_cast<float>(d.p.x), static_cast<float>(d.p.y), static_cast<float>(d.weight), 0.0f));
  } else {
    for (vec2 p : goldenLattice(samples)) directions.push_back(vec4(p.x, p.y, 1.0f / static_cast<float>(samples), 0.0f));
  }
  return directions;
}

/// As many buffers as the budget has room for, each of whole units, so that no unit's codes lie in two.
void RadiosityBake::allocateCache() {
  const uint64_t lumelBytes = uint64_t{4} * static_cast<uint64_t>(params_.samples);
  const uint64_t affordable = rememberedLumels(lumels_, params_);
  lumelsPerCache_ = static_cast<uint32_t>(std::min<uint64_t>(device_.maxStorageBufferBytes() / lumelBytes, 1u << 30));
  if (lumelsPerCache_ > castLumels_) lumelsPerCache_ -= lumelsPerCache_ % castLumels_;
  for (uint64_t first = 0; first < affordable; first += lumelsPerCache_) {
    const uint64_t count = std::min<uint64_t>(lumelsPerCache_, affordable - first);
    cache_.push_back(device_.buffer("radiosity: hit cache " + std::to_string(cache_.size()), count * lumelBytes));
  }
  cacheCapacity_ = static_cast<uint32_t>(affordable);
}

uint64_t RadiosityBake::rememberedLumels(uint64_t lumels, const RadiosityParams& params) {
  return std::min(lumels, (static_cast<uint64_t>(params.hit_cache_mb) << 20) / (uint64_t{4} * static_cast<uint64_t>(params.samples)));
}

void RadiosityBake::uploadPoints() {
  const float offset = scene_.direct.ray_offset * scene_.gpuScene.diagonal;
  if (offset == offset_) return;
  offset_ = offset;
  cached_ = 0;  // rays start elsewhere now
  std::vector<shared::SurfacePoint> points = lumelPoints(*scene_.atlas, offset);
  device_.upload(points_, points.data(), points.size() * sizeof(shared::SurfacePoint));
  if (host_) host_->setPoints(std::move(points));
}

void RadiosityBake::restart(const RadiosityParams& params) {
  params_ = params;
  if (lumels_ == 0) return;
  uploadPoints();
  clearWanted_ = imageStale_ = directImageStale_ = true;
  directSample_ = directFirst_ = 0;
  bounce_ = 0;
  next_ = 0;
  done_ = 0;
  workDone_ = {};
  outcome_ = std::make_shared<Outcome>();
}

uint32_t RadiosityBake::directSamples(const SceneView& scene) {
  return scene.directLight.exactAfterOneSample() ? 1 : static_cast<uint32_t>(scene.direct.lumel_samples);
}

uint32_t RadiosityBake::directRays(const GpuScene& scene) { return std::max(1u, scene.lightCount + (scene.emitterCount > 0 ? 1u : 0u) + 1u); }

/// Lumels a unit of direct light takes: all of them in turn, then the next sample.
static uint32_t directLumels(const Device& device, const GpuScene& scene) {
  return std::max(1u, unitSize(device).directRays / RadiosityBake::directRays(scene));
}

uint64_t RadiosityBake::directUnits() const {
  const uint64_t left = groups(lumels_ - directFirst_, directLumels(device_, scene_.gpuScene));
  const uint64_t whole = groups(lumels_, directLumels(device_, scene_.gpuScene));
  return directSample_ >= directSamples(scene_) ? 0 : left + (directSamples(scene_) - directSample_ - 1) * whole;
}

bool RadiosityBake::settled() const {
  return lumels_ == 0 || (directUnits() == 0 && (bounce_ >= params_.bounces || outcome_->converged));
}

/// The piece of a bounce that starts at `lumel`, when the hits of the first `cached` are remembered.
RadiosityBake::Piece RadiosityBake::pieceAt(uint32_t lumel, uint32_t cached) const {
  Piece piece;
  piece.first = lumel;
  piece.cached = lumel < cached;
  piece.remember = !piece.cached && lumel < cacheCapacity_;
  uint32_t end = piece.cached ? std::min(cached, lumel + cachedLumels_) : std::min(lumels_, lumel + castLumels_);
  if (piece.remember) end = std::min(end, cacheCapacity_);
  if (piece.cached || piece.remember) end = std::min(end, (lumel / lumelsPerCache_ + 1) * lumelsPerCache_);
  piece.count = end - lumel;
  return piece;
}

uint64_t RadiosityBake::piecesFrom(uint32_t lumel, uint32_t cached) const {
  uint64_t pieces = 0;
  while (lumel < lumels_) lumel += pieceAt(lumel, cached).count, ++pieces;
  return pieces;
}

WorkState RadiosityBake::work() const {
  WorkState state;
  state.done = state.total = done_;
  state.residual = outcome_->residual;
  if (settled()) {
    state.label = bounce_ == 0 ? "" : "bounce " + std::to_string(bounce_) + (outcome_->converged ? ": converged" : " of " + std::to_string(params_.bounces));
    return state;
  }
  state.total += directUnits() + piecesFrom(next_, cached_) + static_cast<uint64_t>(params_.bounces - bounce_ - 1) * piecesFrom(0, cacheCapacity_);
  state.label = directUnits() > 0 ? "direct light " + std::to_string(directSample_ + 1) + " of " + std::to_string(directSamples(scene_))
                                  : "bounce " + std::to_string(bounce_ + 1) + " of " + std::to_string(params_.bounces);
  return state;
}

void RadiosityBake::recordClears(FrameGraph& graph) {
  if (!clearWanted_) return;
  clearWanted_ = false;
  graph.clear("radiosity: clear direct light", direct_);
  graph.clear("radiosity: clear irradiance", irradiance_);
  graph.clear("radiosity: clear counters", counters_);
}

void RadiosityBake::recordUnit(FrameGraph& graph) {
  if (settled()) return;
  recordClears(graph);
  if (directUnits() > 0) {
    recordDirect(graph);
  } else {
    const Piece piece = pieceAt(next_, cached_);
    recordPiece(graph, piece);
    next_ += piece.count;
    if (piece.remember) cached_ = next_;
    if (next_ == lumels_) {
      recordReflect(graph);
      recordResidual(graph);
      next_ = 0;
      ++bounce_;
    }
    imageStale_ = true;
  }
  ++done_;
}

void RadiosityBake::recordDirect(FrameGraph& graph) {
  const uint32_t count = std::min(directLumels(device_, scene_.gpuScene), lumels_ - directFirst_);
  scene_.directLight.record(graph, "radiosity: direct light", points_, direct_, directFirst_, count, scene_.seed, directSample_);
  workDone_.directRays += static_cast<double>(count) * directRays(scene_.gpuScene);
  directFirst_ += count;
  if (directFirst_ == lumels_) directFirst_ = 0, ++directSample_;
  directImageStale_ = true;
  if (directUnits() == 0) recordReflect(graph);
}

void RadiosityBake::recordPiece(FrameGraph& graph, const Piece& piece) {
  const bool kept = piece.cached || piece.remember;
  const Buffer& codes = kept ? cache_[piece.first / lumelsPerCache_] : codes_;
  const uint32_t base = kept ? piece.first % lumelsPerCache_ * static_cast<uint32_t>(params_.samples) : 0;
  const double samples = static_cast<double>(piece.count) * params_.samples;
  workDone_.rays += piece.cached ? 0 : samples;
  workDone_.gathered += samples;
  if (!piece.cached) {
    recordCast(graph, piece, codes, base);
  } else {
    for (const char* pass : {"radiosity: make rays", "radiosity: cast rays", "radiosity: find texels"}) graph.skip(pass, "hits are remembered");
  }
  recordGather(graph, piece, codes, base);
}

void RadiosityBake::recordCast(FrameGraph& graph, const Piece& piece, const Buffer& codes, uint32_t codeBase) {
  const uint32_t count = piece.count * static_cast<uint32_t>(params_.samples);
  const shared::RadiosityUnit unit{piece.first, piece.count, codeBase, scene_.seed, resolution_, 0};
  if (host_) {
    for (const char* pass : {"radiosity: make rays", "radiosity: find texels"}) graph.skip(pass, "done where rays are cast");
    graph.host("radiosity: cast rays").write(codes).run([host = host_, codes, unit](HostAccess& memory) { host->cast(unit, memory.span<uint32_t>(codes)); });
    return;
  }
  graph.compute("radiosity: make rays", "radiosity/make_rays.comp")
      .bind("points", points_, Access::Read)
      .bind("directions", directions_, Access::Read)
      .bind("rays", rays_, Access::Write)
      .uniform("radiosity", params_)
      .push(unit)
      .dispatch(piece.count);
  scene_.tracer.record(graph, "radiosity: cast rays", rays_, hits_, count, Query::Closest);
  graph.compute("radiosity: find texels", "passes/find_lumels.comp")
      .bind("rays", rays_, Access::Read)
      .bind("hits", hits_, Access::Read)
      .bind("triangles", triangles_, Access::Read)
      .bind("lumelOfTexel", images_->lumelOfTexel(), Access::Read)
      .bind("codes", codes, Access::Write)
      .push(shared::LumelSearch{count, codeBase, resolution_})
      .dispatchThreads(count);
}

void RadiosityBake::recordGather(FrameGraph& graph, const Piece& piece, const Buffer& codes, uint32_t codeBase) {
  const shared::RadiosityUnit unit{piece.first, piece.count, codeBase, scene_.seed, resolution_, bounce_ == 0 ? 1u : 0u};
  if (host_) {
    graph.host("radiosity: gather")
        .read(codes)
        .read(radiance_)
        .readWrite(irradiance_)
        .readWrite(counters_)
        .run([host = host_, unit, codes, radiance = radiance_, irradiance = irradiance_, counters = counters_](HostAccess& memory) {
          host->gather(unit, memory.span<uint32_t>(codes), memory.span<vec4>(radiance), memory.span<vec4>(irradiance), memory.span<uint32_t>(counters));
        });
    return;
  }
  graph.compute("radiosity: gather", "radiosity/gather.comp")
      .bind("codes", codes, Access::Read)
      .bind("directions", directions_, Access::Read)
      .bind("radiance", radiance_, Access::Read)
      .bind("irradiance", irradiance_, Access::ReadWrite)
      .bind("counters", counters_, Access::ReadWrite)
      .uniform("radiosity", params_)
      .push(unit)
      .dispatch(groups(piece.count, shared::kGatherLumels));
}

void RadiosityBake::recordReflect(FrameGraph& graph) {
  graph.compute("radiosity: reflect", "passes/lightmap_reflect.comp")
      .bind("reflectance", reflectance_, Access::Read)
      .bind("direct", direct_, Access::Read)
      .bind("irradiance", irradiance_, Access::Read)
      .bind("radiance", radiance_, Access::Write)
      .push(lumels_)
      .dispatchThreads(lumels_);
}

/// How much the bounce changed the light, by power: sum of area times |change| over sum of area times irradiance.
void RadiosityBake::recordResidual(FrameGraph& graph) {
  graph.host("radiosity: residual")
      .read(irradiance_)
      .run([outcome = outcome_, irradiance = irradiance_, atlas = scene_.atlas, limit = params_.residual](HostAccess& memory) {
        const std::span<vec4> values = memory.span<vec4>(irradiance);
        double change = 0, total = 0;
        for (size_t i = 0; i < atlas->lumels.size(); ++i) {
          const double area = static_cast<double>(atlas->lumels[i].area);
          change += area * static_cast<double>(values[i].w);
          total += area * static_cast<double>(luminance(vec3(values[i].x, values[i].y, values[i].z)));
        }
        outcome->residual = total > 0 ? change / total : 0;
        outcome->converged = outcome->residual < static_cast<double>(limit) || change == 0;
      });
}

void RadiosityBake::recordImages(FrameGraph& graph) {
  recordClears(graph);
  if (directImageStale_) images_->recordMeans(graph, "direct lightmap", direct_, directImage_);
  directImageStale_ = false;
  if (imageStale_) images_->record(graph, irradiance_);
  else images_->skip(graph, "nothing changed");
  imageStale_ = false;
}

}  // namespace hl
