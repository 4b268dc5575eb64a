// Rays cast by the device's ray tracing pipeline, over an acceleration structure that its driver builds.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "engine/scene/scene_pose.h"
#include "engine/trace/alpha_test.h"
#include "engine/trace/backends.h"

namespace hl {
namespace {

constexpr uint32_t kRow = 1u << 28;  // longer batches are launched in rows; every device launches 2^30 rays at once

bool finite(vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

class PipelineTracer final : public Tracer {
 public:
  PipelineTracer(Device& device, const Scene& scene, const GpuScene& gpuScene) : gpuScene_(gpuScene) {
    const std::vector<bool> tested = alphaTestedTriangles(scene), moving = movingTriangles(scene);
    alpha_ = !tested.empty();
    std::vector<uint32_t> order;  // the scene's triangles in the structures' order: what stays, then what moves, each opaque first
    order.reserve(scene.triangles());
    std::array<uint32_t, 5> begins{};
    for (uint32_t kind = 0; kind < 4; ++kind) {
      for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const uvec3 i = scene.indices[t];
        const uint32_t own = (!moving.empty() && moving[t] ? 2u : 0u) + (alpha_ && tested[t] ? 1u : 0u);
        if (own != kind) continue;
        if (finite(scene.positions[i.x]) && finite(scene.positions[i.y]) && finite(scene.positions[i.z])) order.push_back(t);
      }
      begins[kind + 1] = static_cast<uint32_t>(order.size());
    }
    std::vector<uvec3> indices;
    indices.reserve(order.size());
    for (const uint32_t t : order) indices.push_back(scene.indices[t]);
    const Buffer sorted = device.buffer("pipeline: indices", std::span<const uvec3>(indices));
    triangles_ = device.buffer("pipeline: triangles", std::span<const uint32_t>(order));
    firstTested_ = begins[1], firstMoving_ = begins[2], firstMovingTested_ = begins[3];

    const auto vertices = static_cast<uint32_t>(scene.positions.size());
    // The first of each is there even when it is empty: a triangle's geometry tells whether it is tested.
    const auto geometries = [&](uint32_t first) {
      std::vector<TriangleGeometry> list;
      if (begins[first + 2] > begins[first]) list.push_back({gpuScene.positions, sorted, vertices, begins[first], begins[first + 1] - begins[first], true});
      if (begins[first + 2] > begins[first + 1])
        list.push_back({gpuScene.positions, sorted, vertices, begins[first + 1], begins[first + 2] - begins[first + 1], false});
      return list;
    };
    moves_ = begins[4] > begins[2];
    structure_ = device.accelerationStructure("pipeline: structure", geometries(0), geometries(2));
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
    if (closest || alpha_)
      pass.bind("sceneTriangles", triangles_, Access::Read)
          .specialize("kFirstTested", firstTested_)
          .specialize("kFirstMoving", firstMoving_)
          .specialize("kFirstMovingTested", firstMovingTested_);
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

  void recordUpdate(FrameGraph& graph) override {
    if (moves_) graph.update("pipeline: update structure", structure_);
  }

  std::vector<std::pair<std::string, uint64_t>> memory() const override {
    return {{"pipeline: structure", structure_.bytes()}, {"pipeline: triangles", triangles_.size()}};
  }

 private:
  const GpuScene gpuScene_;
  AccelerationStructure structure_;
  Buffer triangles_;
  uint32_t firstTested_ = 0, firstMoving_ = 0, firstMovingTested_ = 0;  ///< in triangles_
  bool alpha_ = false, moves_ = false;
};

}  // namespace

std::unique_ptr<Tracer> makePipelineTracer(Device& device, const Scene& scene, const GpuScene& gpuScene) {
  return std::make_unique<PipelineTracer>(device, scene, gpuScene);
}

}  // namespace hl
