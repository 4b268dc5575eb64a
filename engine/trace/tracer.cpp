#include "engine/trace/tracer.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/trace/backends.h"

namespace hl {
namespace {

std::string available(const Device& device) {
  std::string ids;
  for (const TracerListing& t : listTracers(device))
    if (t.available) ids += (ids.empty() ? "" : ", ") + t.id;
  return ids;
}

void checkSize(const std::string& pass, const Buffer& buffer, uint64_t needed) {
  if (!buffer || buffer.size() < needed)
    throw badInput(pass + ": buffer " +
                   (buffer ? buffer.name() + " has " + std::to_string(buffer.size()) : std::string("(none) has 0")) +
                   " bytes, the batch takes " + std::to_string(needed));
}

}  // namespace

void Tracer::closest(RayPacket&, size_t) const {
  throw Error(ErrorKind::Run, std::string("tracer ") + id() + " casts no rays on the host");
}

void checkBatch(const std::string& pass, const Buffer& rays, const Buffer& out, uint32_t count, Query query) {
  if (count == 0) return;
  checkSize(pass, rays, uint64_t{count} * sizeof(shared::Ray));
  checkSize(pass, out, uint64_t{count} * (query == Query::Closest ? sizeof(shared::Hit) : sizeof(uint32_t)));
}

std::vector<TracerListing> listTracers(const Device& device) {
  // embree and bvh need nothing that the engine does not already ask of every device.
  const bool rays = device.rayPipelines();
  return {{"embree", true, ""}, {"bvh", true, ""}, {"pipeline", rays, rays ? "" : "this device has no ray tracing pipelines"}};
}

TracerFeatures tracerFeatures(const Device& device) {
  const auto& features = device.info().features;  // the engine uses no queries: they are only listed
  const auto queries = std::find_if(features.begin(), features.end(), [](const auto& f) { return f.first == "ray queries"; });
  return {device.isCpu(), device.rayPipelines(), queries != features.end() && queries->second};
}

const char* automaticTracer(const TracerFeatures& f) { return f.cpu ? "embree" : f.rayPipelines && f.rayQueries ? "pipeline" : "bvh"; }

std::unique_ptr<Tracer> makeTracer(const std::string& id, Device& device, ShaderLibrary&, const Scene& scene,
                                   const GpuScene& gpuScene, std::shared_ptr<EmbreeScene> embree, TaskPool& pool,
                                   Progress* progress) {
  const std::string chosen = id == "auto" ? automaticTracer(tracerFeatures(device)) : id;
  if (chosen == "embree") {
    if (!embree) embree = std::make_shared<EmbreeScene>(scene, progress);
    return makeEmbreeTracer(std::move(embree), pool);
  }
  if (chosen == "bvh") return makeBvhTracer(device, scene, gpuScene, pool, progress);
  if (chosen == "pipeline" && device.rayPipelines()) return makePipelineTracer(device, scene, gpuScene);
  for (const TracerListing& t : listTracers(device))
    if (t.id == chosen) throw badInput("tracer \"" + id + "\" is not available: " + t.reason + "; there are auto, " + available(device));
  throw badInput("unknown tracer \"" + id + "\": available are auto, " + available(device));
}

}  // namespace hl
