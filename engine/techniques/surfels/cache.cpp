#include "engine/techniques/surfels/cache.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "shaders/shared/ray.h"

namespace hl {
namespace {

constexpr uint64_t kDepthBytes = uint64_t{shared::kDepthSide} * shared::kDepthSide * sizeof(vec2);
constexpr uint64_t kGuideBytes = uint64_t{shared::kGuideSide} * shared::kGuideSide * sizeof(float);

/// From this share of tiles or hits on that lack surfels they are placed in every frame, provided that this share of the memory is free.
constexpr float kManyLack = 1.0f / 64.0f;

void checkSize(const Device& device, const char* what, uint64_t bytes) {
  if (bytes > device.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, std::string("surfels: ") + what + " take " + std::to_string(bytes) + " bytes, a buffer of this device holds " +
                                       std::to_string(device.maxStorageBufferBytes()) + "; lower surfels.max_surfels");
}

}  // namespace

SurfelCache::SurfelCache(Gpu& gpu, const SceneView& scene, const SurfelsParams& params)
    : device_(gpu.device),
      scene_(scene),
      maxSurfels_(static_cast<uint32_t>(params.max_surfels)),
      depthTest_(params.depth_test != 0),
      guiding_(params.guiding != 0),
      hitSurfaces_(gpu.device, scene.gpuScene, scene.directLight) {
  if (params.estimator == kEstimatorMean && params.freeze_frames == 0)
    throw badInput("surfels.estimator mean: a plain mean over a cache that feeds itself never forgets how dark it began, so it only starts once the cache is frozen; set "
                   "surfels.freeze_frames, to 256 say, or take multi_scale");
  // No surfel reaches farther than the edge of a cell.
  const float share = params.sizing == kSizingWorld ? std::max(params.radius, std::min(params.hit_reach * params.radius, params.radius_max)) : params.radius_max;
  const float diagonal = scene.gpuScene.diagonal > 0 ? scene.gpuScene.diagonal : 1.0f;
  const GridPlan plan = planGrid(scene.scene.bounds, share * diagonal);
  const uint64_t n = maxSurfels_;
  checkSize(device_, "estimates", n * sizeof(shared::SurfelState));
  checkSize(device_, "records", n * shared::kRecordTexels * sizeof(vec4));
  if (depthTest_) checkSize(device_, "maps of distances", n * kDepthBytes);
  if (guiding_) checkSize(device_, "guides", n * kGuideBytes);
  if (n * shared::kRecordTexels > device_.maxTexelBufferElements())
    throw Error(ErrorKind::TooLarge, "surfels: " + std::to_string(n) + " surfels are more than this device's texel buffers hold (" +
                                       std::to_string(device_.maxTexelBufferElements() / shared::kRecordTexels) + "); lower surfels.max_surfels");
  grid_ = std::make_unique<SurfelGrid>(device_, plan, maxSurfels_, params.grid == kGridCamera, params.hit_reach);
  prefix_ = std::make_unique<PrefixSum>(device_, PrefixSum::kMost);
  sites_ = device_.buffer("surfels: sites", n * sizeof(shared::Surfel));
  states_ = device_.buffer("surfels: estimates", n * sizeof(shared::SurfelState));
  records_ = device_.buffer("surfels: records", n * shared::kRecordTexels * sizeof(vec4), TexelFormat::RGBA32F);
  depth_ = depthTest_ ? device_.buffer("surfels: distances", n * kDepthBytes) : device_.buffer("surfels: no distances", kDepthBytes);
  guide_ = guiding_ ? device_.buffer("surfels: guides", n * kGuideBytes) : device_.buffer("surfels: no guides", kGuideBytes);
  totals_ = device_.buffer("surfels: totals", sizeof(shared::SurfelTotals));
  freeIds_ = device_.buffer("surfels: free numbers", n * sizeof(uint32_t));
  claims_ = device_.buffer("surfels: claims", shared::kClaimSlots * sizeof(uint32_t));
  shares_ = device_.buffer("surfels: shares", n * sizeof(uint32_t));
  shareSums_ = device_.buffer("surfels: sums of shares", (n + 1) * sizeof(uint32_t));
  recycleFlags_ = device_.buffer("surfels: recycled", n * sizeof(uint32_t));
  recycleOrder_ = device_.buffer("surfels: order of recycled", (n + 1) * sizeof(uint32_t));
  restart();
}

void SurfelCache::restart() {
  frame_ = harvested_ = lastPlaced_ = 0;
  listsStand_ = false;
  age_ = 0;
  still_ = casts_ = 0;
  lastParams_ = {};
  lastFrame_ = {};
  last_ = {};
  sums_ = {};
  raysCast_ = 0;
  hitSurfaces_.resetCounters();
}

/// What the last frame left, once it has run.
void SurfelCache::harvest() {
  if (harvested_ == frame_) return;
  shared::SurfelTotals t;
  device_.download(totals_, &t, sizeof t);
  if (t.stamp != frame_) return;  // recorded, and not run
  harvested_ = frame_;
  last_ = t;
  for (size_t i = 0; i < sums_.size(); ++i) sums_[i] += static_cast<double>(t.counters[i]);
  raysCast_ += lastFrame_.rays;
}

bool SurfelCache::moved(const FrameInputs& in, const shared::SurfelFrame& f) const {
  const shared::SurfelFrame& l = lastFrame_;
  return frame_ == 0 || in.cameraMoved || in.geometryMoved || f.eye != l.eye || f.forward != l.forward || f.right != l.right || f.down != l.down || f.width != l.width ||
         f.height != l.height || f.pixelAngle != l.pixelAngle || f.lists != l.lists;
}

bool SurfelCache::lacksSurfels(const SurfelsParams& params) const {
  const auto many = [](uint32_t some, uint32_t of) { return static_cast<float>(some) > kManyLack * static_cast<float>(of); };
  if (!many(maxSurfels_ - std::min(last_.alive, maxSurfels_), maxSurfels_)) return false;  // there is no memory for them
  return many(last_.counters[shared::kCountPlacedPixels], lastFrame_.tiles) || (params.spawn_at_hits != 0 && many(last_.counters[shared::kCountUncoveredHits], last_.counters[shared::kCountHits]));
}

/// Buffers by ray and by candidate grow by half, at least, and never shrink.
void SurfelCache::reserve(const shared::SurfelFrame& f, bool splat) {
  const uint64_t rays = f.rays, candidates = f.candidates;
  const auto grow = [&](Buffer& b, const char* name, uint64_t count, uint64_t each) {
    if (b && b.size() >= count * each) return;
    const uint64_t held = b ? b.size() / each : 0;
    const uint64_t wanted = std::min(std::max(count, held + held / 2), std::max(count, device_.maxStorageBufferBytes() / each));
    checkSize(device_, name, count * each);
    b = device_.buffer(std::string("surfels: ") + name, std::max<uint64_t>(wanted, 64) * each);
  };
  grow(ray_.rays, "rays", rays, sizeof(shared::Ray));
  grow(ray_.hits, "hits", rays, sizeof(shared::Hit));
  grow(ray_.samples, "ray samples", rays, sizeof(shared::RaySample));
  grow(ray_.arrivals, "arrivals", rays, sizeof(vec4));
  grow(candidates_, "candidates", candidates, sizeof(shared::Candidate));
  grow(placeFlags_, "accepted candidates", candidates, sizeof(uint32_t));
  grow(placeOrder_, "order of candidates", candidates + 1, sizeof(uint32_t));
  if (!splat) return;
  grow(tileDepths_, "depths of tiles", f.lists - f.cells, sizeof(vec2));
  newLists_ = grid_->reserve(f.lists - f.cells) || newLists_;
}

shared::SurfelFrame SurfelCache::frameOf(const FrameInputs& in, const SurfelsParams& params) const {
  const GridPlan& plan = grid_->plan();
  shared::SurfelFrame f{};
  f.gridOrigin = plan.origin;
  f.cellSize = plan.cellSize;
  f.gridSize = plan.size;
  f.cells = plan.cells();
  const CameraBasis view = cameraBasis(in.camera, static_cast<float>(in.gbuffer.width) / static_cast<float>(in.gbuffer.height));
  f.forward = view.forward;
  f.right = view.right / glm::dot(view.right, view.right), f.down = view.down / glm::dot(view.down, view.down);
  f.width = static_cast<uint32_t>(in.gbuffer.width), f.height = static_cast<uint32_t>(in.gbuffer.height);
  f.eye = in.camera.position;
  f.pixelAngle = 2 * std::tan(0.5f * in.camera.verticalFov) / static_cast<float>(in.gbuffer.height);
  f.diagonal = scene_.gpuScene.diagonal;
  f.radius = params.radius * f.diagonal;
  f.radiusMax = params.radius_max * f.diagonal;
  if (grid_->camera()) {
    const float least = params.sizing == kSizingScreen ? shared::kLeastRadius * f.radiusMax : f.radius;
    const float perMetre = params.sizing == kSizingScreen ? params.radius_pixels * f.pixelAngle : 0;
    const float most = params.sizing == kSizingScreen ? f.radiusMax : std::max(f.radius, std::min(params.hit_reach * f.radius, f.radiusMax));
    const CameraGridPlan around = planCameraGrid(scene_.scene.bounds, f.eye, std::min(least, most), perMetre, most);
    f.grid = around.shape;
    f.cells = around.cells;
    std::copy(around.regions.begin(), around.regions.end(), f.regions);
  }
  const auto tilesOf = [](uint32_t pixels) { return (pixels + shared::kSplatPixels - 1) / shared::kSplatPixels; };
  f.lists = f.cells + (params.gather == kGatherSplat ? tilesOf(f.width) * tilesOf(f.height) : 0);
  f.entriesMost = grid_->room();
  f.frozen = params.freeze_frames > 0 && frame_ >= static_cast<uint32_t>(params.freeze_frames) ? 1 : 0;
  f.justFrozen = f.frozen != 0 && frame_ == static_cast<uint32_t>(params.freeze_frames) ? 1 : 0;
  f.frame = frame_;
  f.seed = in.seed;
  f.lightChanged = in.lightsChanged ? 1 : 0;
  f.age = 1 + (in.lightsChanged && params.change_samples > 0 ? std::min(age_, params.change_samples) : age_);
  f.surfels = last_.highWater;
  f.maxSurfels = maxSurfels_;
  const double inView = std::min(last_.inView, last_.alive);
  const double counted = params.budget_in_view != 0 ? inView + static_cast<double>(params.hidden_share) * (last_.alive - inView) : last_.alive;
  const bool moves = moved(in, f), lacks = lacksSurfels(params);
  f.still = moves || in.lightsChanged || std::memcmp(&params, &lastParams_, sizeof params) != 0 ? 0 : still_;
  const auto settleFrames = static_cast<uint32_t>(params.settle_frames);
  const bool settled = f.frozen == 0 && params.estimator != kEstimatorEma && !lacks && f.still >= settleFrames;
  const uint32_t every = settled ? static_cast<uint32_t>(params.settled_every) : 1, turn = settled ? (f.still - settleFrames) % every : 0;
  f.casts = turn == 0 ? 1 : 0;
  f.gathers = turn == every / 2 ? 1 : 0;
  f.recent = std::max(shared::kRecentFrames + every - 1, f.still == 0 && lastFrame_.still > 0 ? lastFrame_.recent : 0);  // what was in view while resting is so in the frame that wakes
  const double young = last_.alive > 0 ? static_cast<double>(last_.young) / static_cast<double>(shared::kYoungUnit) : 0;
  const uint64_t most = std::min<uint64_t>(hitSurfaces_.largestBatch(), PrefixSum::kMost / 2);
  f.rays = f.casts != 0 ? static_cast<uint32_t>(std::min<uint64_t>(std::llround(static_cast<double>(params.ray_budget) * (counted + young)), static_cast<long long>(most))) : 0;
  const int placeEvery = settled ? std::max(params.place_every, params.settled_place_every) : params.place_every;
  f.places = f.frozen == 0 && (moves || lacks || (f.casts != 0 && frame_ - lastPlaced_ >= static_cast<uint32_t>(placeEvery))) ? 1 : 0;  // hits ask for surfels, too
  f.listed = f.surfels > 0 && (moves || !listsStand_) ? 1 : 0;
  f.tilesX = (static_cast<uint32_t>(in.gbuffer.width) + shared::kTilePixels - 1) / shared::kTilePixels;
  f.tiles = f.tilesX * ((static_cast<uint32_t>(in.gbuffer.height) + shared::kTilePixels - 1) / shared::kTilePixels);
  f.candidates = f.tiles + f.rays;
  f.fill = static_cast<float>(last_.alive) / static_cast<float>(maxSurfels_);
  return f;
}

}  // namespace hl
