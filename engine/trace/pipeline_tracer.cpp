// Rays cast by the device's ray tracing pipeline, over an acceleration structure that its driver builds.
#include <algorithm>
#include <cmath>
#include <string>

#include "engine/trace/alpha_test.h"
#include "engine/trace/backends.h"

namespace hl {
namespace {

constexpr uint32_t kRow = 1u << 28;  // longer batches are launched in rows; every device launches 2^30 rays at once

bool finite(vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

class PipelineTracer final : public Tracer {
 public:
  PipelineTracer(Device& device, const Scene& scene, const GpuScene& gpuScene) : gpuScene_(gpuScene) {
    const std::vector<bool> tested = alphaTestedTriangles(scene);
    alpha_ = !tested.empty();
    std::vector<uint32_t> order;  // the scene's triangles in the structure's order
    order.reserve(scene.triangles());
    for (const bool second : {false, true}) {
      if (second) opaque_ = static_cast<uint32_t>(order.size());
      for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const uvec3 i = scene.indices[t];
        if ((alpha_ && tested[t]) != second) continue;
        if (finite(scene.positions[i.x]) && finite(scene.positions[i.y]) && finite(scene.positions[i.z])) order.push_back(t);
      }
    }
    std::vector<uvec3> indices;
    indices.reserve(order.size());
    for (const uint32_t t : order) indices.push_back(scene.indices[t]);
    const Buffer sorted = device.buffer("pipeline: indices", std::span<const uvec3>(indices));
    triangles_ = device.buffer("pipeline: triangles", std::span<const uint32_t>(order));

    const auto vertices = static_cast<uint32_t>(scene.positions.size()), all = static_cast<uint32_t>(order.size());
    std::vector<TriangleGeometry> geometries;
    // The first is there even when it is empty: a triangle's geometry tells whether it is tested.
    if (all > 0) geometries.push_back({gpuScene.positions, sorted, vertices, 0, opaque_, true});
    if (all > opaque_) geometries.push_back({gpuScene.positions, sorted, vertices, opaque_, all - opaque_, false});
    structure_ = device.accelerationStructure("pipeline: structure", geometries);
  }

  const char* id() const override { return "pipeline"; }

  void record(FrameGraph& graph, const std::string& name, const Buffer& rays, const Buffer& out, uint32_t count, Query query) override {
    checkBatch(name, rays, out, count, query);
    if (count == 0) return graph.skip(name, "no rays");
    const bool closest = query == Query::Closest;
    RayShaders shaders;
    shaders.generation = closest ? "pipeline/closest.rgen" : "pipeline/any.rgen";
    shaders.miss = closest ? "pipeline/closest.rmiss" : "pipeline/any.rmiss";
    if (closest) shaders.closestHit = "pipeline/closest.rchit";
    if (alpha_) shaders.anyHit = "pipeline/alpha.rahit";
    RayPass pass = graph.rays(name, shaders);
    pass.bind("sceneStructure", structure_).bind("rays", rays, Access::Read).bind("result", out, Access::Write).push(count);
    if (closest || alpha_) pass.bind("sceneTriangles", triangles_, Access::Read).specialize("kFirstTested", opaque_);
    if (alpha_) {
      pass.bind("uvs", gpuScene_.uvs, Access::Read)
          .bind("indices", gpuScene_.indices, Access::Read)
          .bind("materialIds", gpuScene_.materialIds, Access::Read)
          .bind("materials", gpuScene_.materials, Access::Read)
          .sample("textures", gpuScene_.textures);
    }
    const uint32_t width = std::min(count, kRow);
    pass.launch(width, (count + width - 1) / width);
  }

  std::vector<std::pair<std::string, uint64_t>> memory() const override {
    return {{"pipeline: structure", structure_.bytes()}, {"pipeline: triangles", triangles_.size()}};
  }

 private:
  const GpuScene gpuScene_;
  AccelerationStructure structure_;
  Buffer triangles_;
  uint32_t opaque_ = 0;  ///< triangles that need no test: geometry 0
  bool alpha_ = false;
};

}  // namespace

std::unique_ptr<Tracer> makePipelineTracer(Device& device, const Scene& scene, const GpuScene& gpuScene) {
  return std::make_unique<PipelineTracer>(device, scene, gpuScene);
}

}  // namespace hl
