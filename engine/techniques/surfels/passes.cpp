// A frame of the cache, pass by pass.
#include "engine/techniques/surfels/cache.h"

namespace hl {

void SurfelCache::record(FrameGraph& graph, const FrameInputs& in, const SurfelsParams& params, const GpuImage& result) {
  harvest();
  const shared::SurfelFrame f = frameOf(in, params);
  const bool splat = params.gather == kGatherSplat;
  reserve(f, splat);
  const char* const settled = "settled, and its turn is in another of settled_every frames";
  recordClears(graph, f);
  recordTileDepths(graph, f, in.gbuffer, splat);
  if (f.listed != 0)
    grid_->record(graph, *prefix_, f, params, sites_, states_, records_, totals_, scene_.gpuScene.objectTransforms,
                  splat ? tileDepths_ : Buffer());
  else
    graph.skip("surfels: count cells", f.surfels == 0 ? "there is no surfel yet" : "the lists are the last frame's");
  if (f.rays > 0)
    recordRays(graph, f, params);
  else
    graph.skip("surfels: cast rays", f.surfels == 0 ? "there is no surfel yet" : f.casts == 0 ? settled : "ray_budget is 0");
  if (f.surfels > 0 && f.casts != 0) recordUpdate(graph, f, params);
  if (f.gathers != 0)
    recordGather(graph, f, params, in.gbuffer, result);
  else
    graph.skip("surfels: gather", settled);
  const char* const unchanged = f.frozen != 0 ? "the cache is frozen" : "nothing moves, and place_every has not passed";
  if (f.places != 0)
    recordPlace(graph, f, params, in.gbuffer, result);
  else
    graph.skip("surfels: place", unchanged);
  if (f.surfels > 0 && params.recycle != 0 && f.places != 0)
    recordRecycle(graph, f, params);
  else
    graph.skip("surfels: recycle", params.recycle == 0 ? "switched off" : f.places == 0 ? unchanged : "there is no surfel yet");
  graph.compute("surfels: end frame", "surfels/end_frame.comp")
      .bind("totals", totals_, Access::ReadWrite)
      .bind("placedOrder", placeOrder_, Access::Read)
      .uniform("frame", f)
      .dispatch(1);
  if (f.listed != 0 || f.places != 0) listsStand_ = f.places == 0;
  if (f.places != 0) lastPlaced_ = f.frame;
  if (f.casts != 0) ++casts_;
  lastParams_ = params;
  lastFrame_ = f;
  age_ = f.age;
  still_ = f.still + 1;
  ++frame_;
}

void SurfelCache::recordClears(FrameGraph& graph, const shared::SurfelFrame& f) {
  graph.compute("surfels: begin frame", "surfels/begin_frame.comp").bind("totals", totals_, Access::ReadWrite).uniform("frame", f).dispatch(1);
  if (f.places != 0)
    graph.clear("surfels: clear claims", claims_, 0xffffffffu);
  else
    graph.skip("surfels: clear claims", "no surfel is placed");
  if (f.frame == 0) {
    graph.clear("surfels: clear records", records_);
    graph.clear("surfels: clear estimates", states_);
  }
  if (f.frame == 0 || newLists_) grid_->recordEmpty(graph);
  newLists_ = false;
}

void SurfelCache::recordTileDepths(FrameGraph& graph, const shared::SurfelFrame& f, const GBuffer& g, bool splat) {
  if (!splat || f.listed == 0) {
    graph.skip("surfels: tile depths", !splat ? "pixels ask the grid" : f.surfels == 0 ? "there is no surfel yet" : "the lists are the last frame's");
    return;
  }
  graph.compute("surfels: tile depths", "surfels/tile_depths.comp")
      .bind("position", g.position, Access::Read)
      .bind("tileDepths", tileDepths_, Access::Write)
      .uniform("frame", f)
      .dispatchThreads(f.width, f.height);
}

ComputePass& SurfelCache::bindLookup(ComputePass& pass, const shared::SurfelFrame& f, const SurfelsParams& params) const {
  return pass.bind("records", records_, Access::Read)
      .bind("cellOffsets", grid_->offsets(), Access::Read)
      .bind("cellEntries", grid_->entries(), Access::Read)
      .bind("depthMoments", depth_, Access::Read)
      .uniform("frame", f)
      .uniform("surfels", params)
      .specialize("kDepthTest", depthTest_ ? 1 : 0)
      .specialize("kCameraGrid", grid_->camera() ? 1 : 0);
}

void SurfelCache::recordRays(FrameGraph& graph, const shared::SurfelFrame& f, const SurfelsParams& params) {
  const float offset = scene_.direct.ray_offset * scene_.gpuScene.diagonal;
  graph.compute("surfels: allot rays", "surfels/allot_rays.comp")
      .bind("states", states_, Access::Read)
      .bind("totals", totals_, Access::Read)
      .bind("shares", shares_, Access::Write)
      .uniform("frame", f)
      .uniform("surfels", params)
      .dispatchThreads(f.surfels);
  prefix_->record(graph, "surfels: sums of shares", shares_, shareSums_, f.surfels);
  graph.compute("surfels: make rays", "surfels/make_rays.comp")
      .bind("shareSums", shareSums_, Access::Read)
      .bind("sites", sites_, Access::Read)
      .bind("states", states_, Access::Read)
      .bind("records", records_, Access::Read)
      .bind("guideMaps", guide_, Access::Read)
      .bind("rays", ray_.rays, Access::Write)
      .bind("samples", ray_.samples, Access::Write)
      .uniform("frame", f)
      .uniform("surfels", params)
      .specialize("kGuiding", guiding_ ? 1 : 0)
      .push(offset)
      .dispatchThreads(f.rays);
  scene_.tracer.record(graph, "surfels: cast rays", ray_.rays, ray_.hits, f.rays, Query::Closest);
  HitSurfaces::Rays batch;
  batch.rays = ray_.rays, batch.hits = ray_.hits;
  batch.count = f.rays;
  batch.offset = offset;
  batch.seed = f.seed;
  batch.sample = casts_;  // not the frame: every fourth point of a sequence is none
  hitSurfaces_.record(graph, "surfels", batch);
  ComputePass shade = graph.compute("surfels: shade hits", "surfels/shade_hits.comp");
  bindLookup(shade, f, params)
      .bind("states", states_, Access::ReadWrite)
      .bind("totals", totals_, Access::ReadWrite)
      .bind("claims", claims_, Access::ReadWrite)
      .bind("candidates", candidates_, Access::ReadWrite)
      .bind("samples", ray_.samples, Access::Read)
      .bind("hits", ray_.hits, Access::Read)
      .bind("points", hitSurfaces_.points(), Access::Read)
      .bind("albedo", hitSurfaces_.albedo(), Access::Read)
      .bind("direct", hitSurfaces_.direct(), Access::Read)
      .bind("arrivals", ray_.arrivals, Access::Write)
      .dispatchThreads(f.rays);
}

void SurfelCache::recordUpdate(FrameGraph& graph, const shared::SurfelFrame& f, const SurfelsParams& params) {
  graph.compute("surfels: update estimate", "surfels/update_estimate.comp")
      .bind("sites", sites_, Access::Read)
      .bind("states", states_, Access::ReadWrite)
      .bind("records", records_, Access::ReadWrite)
      .bind("totals", totals_, Access::ReadWrite)
      .bind("guideMaps", guide_, Access::ReadWrite)
      .bind("depthMoments", depth_, Access::ReadWrite)
      .bind("shareSums", shareSums_, Access::Read)
      .bind("samples", ray_.samples, Access::Read)
      .bind("arrivals", ray_.arrivals, Access::Read)
      .uniform("frame", f)
      .uniform("surfels", params)
      .specialize("kDepthTest", depthTest_ ? 1 : 0)
      .specialize("kGuiding", guiding_ ? 1 : 0)
      .dispatchThreads(f.surfels);
}

void SurfelCache::recordGather(FrameGraph& graph, const shared::SurfelFrame& f, const SurfelsParams& params, const GBuffer& g, const GpuImage& result) {
  const bool halves = params.gather == kGatherHalfResolution;
  const int width = halves ? (g.width + 1) / 2 : g.width, height = halves ? (g.height + 1) / 2 : g.height;
  const GpuImage target = halves ? graph.transient("surfels.half", {width, height, Format::RGBA32F}) : result;
  ComputePass gather = graph.compute("surfels: gather", "surfels/gather.comp");
  bindLookup(gather, f, params)
      .bind("states", states_, Access::ReadWrite)
      .bind("totals", totals_, Access::ReadWrite)
      .bind("position", g.position, Access::Read)
      .bind("geometricNormal", g.geometricNormal, Access::Read)
      .bind("result", target, Access::Write)
      .specialize("kStep", halves ? 2 : 1)
      .specialize("kSplat", params.gather == kGatherSplat ? 1 : 0)
      .dispatchThreads(static_cast<uint32_t>(width), static_cast<uint32_t>(height));
  if (!halves) {
    graph.skip("surfels: upsample", "every pixel gathers");
    return;
  }
  ComputePass upsample = graph.compute("surfels: upsample", "surfels/upsample.comp");
  bindLookup(upsample, f, params)
      .bind("totals", totals_, Access::ReadWrite)
      .bind("position", g.position, Access::Read)
      .bind("geometricNormal", g.geometricNormal, Access::Read)
      .bind("halved", target, Access::Read)
      .bind("result", result, Access::Write)
      .dispatchThreads(static_cast<uint32_t>(g.width), static_cast<uint32_t>(g.height));
}

void SurfelCache::recordPlace(FrameGraph& graph, const shared::SurfelFrame& f, const SurfelsParams& params, const GBuffer& g, const GpuImage& result) {
  graph.compute("surfels: find gaps", "surfels/find_gaps.comp")
      .bind("claims", claims_, Access::ReadWrite)
      .bind("candidates", candidates_, Access::ReadWrite)
      .bind("position", g.position, Access::Read)
      .bind("geometricNormal", g.geometricNormal, Access::Read)
      .bind("ids", g.ids, Access::Read)
      .bind("irradiance", result, Access::Read)
      .uniform("frame", f)
      .uniform("surfels", params)
      .dispatch(f.tilesX, f.tiles / f.tilesX);
  graph.compute("surfels: accept", "surfels/accept.comp")
      .bind("claims", claims_, Access::Read)
      .bind("candidates", candidates_, Access::Read)
      .bind("flags", placeFlags_, Access::Write)
      .uniform("frame", f)
      .uniform("surfels", params)
      .dispatchThreads(f.candidates);
  prefix_->record(graph, "surfels: order of new ones", placeFlags_, placeOrder_, f.candidates);
  graph.compute("surfels: place", "surfels/place.comp")
      .bind("states", states_, Access::ReadWrite)
      .bind("records", records_, Access::ReadWrite)
      .bind("totals", totals_, Access::ReadWrite)
      .bind("candidates", candidates_, Access::Read)
      .bind("flags", placeFlags_, Access::Read)
      .bind("order", placeOrder_, Access::Read)
      .bind("freeIds", freeIds_, Access::Read)
      .bind("sites", sites_, Access::ReadWrite)
      .bind("object_ids", scene_.gpuScene.objectIds, Access::Read)
      .bind("object_transforms", scene_.gpuScene.objectTransforms, Access::Read)
      .bind("depthMoments", depth_, Access::ReadWrite)
      .bind("guideMaps", guide_, Access::ReadWrite)
      .uniform("frame", f)
      .uniform("surfels", params)
      .specialize("kDepthTest", depthTest_ ? 1 : 0)
      .specialize("kGuiding", guiding_ ? 1 : 0)
      .dispatchThreads(f.candidates);
}

void SurfelCache::recordRecycle(FrameGraph& graph, const shared::SurfelFrame& f, const SurfelsParams& params) {
  ComputePass choose = graph.compute("surfels: choose recycled", "surfels/choose_recycled.comp");
  bindLookup(choose, f, params).bind("states", states_, Access::Read).bind("flags", recycleFlags_, Access::Write).dispatchThreads(f.surfels);
  prefix_->record(graph, "surfels: order of recycled", recycleFlags_, recycleOrder_, f.surfels);
  graph.compute("surfels: recycle", "surfels/recycle.comp")
      .bind("states", states_, Access::ReadWrite)
      .bind("records", records_, Access::ReadWrite)
      .bind("totals", totals_, Access::ReadWrite)
      .bind("flags", recycleFlags_, Access::Read)
      .bind("order", recycleOrder_, Access::Read)
      .bind("placedOrder", placeOrder_, Access::Read)
      .bind("freeIds", freeIds_, Access::ReadWrite)
      .uniform("frame", f)
      .dispatchThreads(f.surfels);
}

void SurfelCache::recordView(FrameGraph& graph, const FrameInputs& in, const SurfelsParams& params, const GpuImage& irradiance, const GpuImage& target,
                             uint32_t what) {
  ComputePass show = graph.compute("surfels: view", "surfels/show.comp");
  bindLookup(show, lastFrame_, params)
      .bind("states", states_, Access::Read)
      .bind("sites", sites_, Access::Read)
      .bind("position", in.gbuffer.position, Access::Read)
      .bind("geometricNormal", in.gbuffer.geometricNormal, Access::Read)
      .bind("irradiance", irradiance, Access::Read)
      .bind("result", target, Access::Write)
      .push(what)
      .dispatchThreads(static_cast<uint32_t>(in.gbuffer.width), static_cast<uint32_t>(in.gbuffer.height));
}

}  // namespace hl
