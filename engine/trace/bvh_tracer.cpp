// Rays cast by compute shaders over a tree in texel buffers.
#include <algorithm>
#include <string>

#include "engine/core/error.h"
#include "engine/trace/alpha_test.h"
#include "engine/trace/backends.h"
#include "engine/trace/bvh.h"

namespace hl {
namespace {

constexpr uint32_t kGroup = 64;  // local_size_x of shaders/bvh/traverse.glsl
/// On a CPU, where eight rays walk in step, threads that take several in turn keep all eight busy: 1.2 times the rate
/// on Sponza for the closest hit, 1.6 times for any hit. Elsewhere many threads are worth more.
constexpr uint32_t kRaysPerThreadOnCpu = 16;
constexpr uint32_t kMaxGroupsPerRow = 32768;  // every device takes 65535 groups in a dimension; the shader counts rows

Buffer texels(Device& device, const char* name, const std::vector<vec4>& data) {
  if (data.size() > device.maxTexelBufferElements())
    throw Error(ErrorKind::TooLarge, "tracer bvh: " + std::string(name) + " takes " + std::to_string(data.size()) +
                                       " texels, but a texel buffer of this device holds " +
                                       std::to_string(device.maxTexelBufferElements()) + "; use --tracer embree");
  Buffer buffer = device.buffer(name, std::max<uint64_t>(1, data.size()) * sizeof(vec4), TexelFormat::RGBA32F);
  if (!data.empty()) device.upload(buffer, data.data(), data.size() * sizeof(vec4));
  return buffer;
}

class BvhTracer final : public Tracer {
 public:
  BvhTracer(Device& device, const Scene& scene, const GpuScene& gpuScene, TaskPool& pool, Progress* progress)
      : gpuScene_(gpuScene) {
    const std::vector<bool> tested = alphaTestedTriangles(scene);
    const Bvh bvh = buildBvh(scene, tested, pool, progress);
    alpha_ = !tested.empty();
    stackSize_ = bvh.stackSize;
    raysPerThread_ = device.isCpu() ? kRaysPerThreadOnCpu : 1;
    nodes_ = texels(device, "bvh: nodes", bvh.nodes);
    triangles_ = texels(device, "bvh: triangles", bvh.triangles);
  }

  const char* id() const override { return "bvh"; }

  void record(FrameGraph& graph, const std::string& name, const Buffer& rays, const Buffer& out, uint32_t count,
              Query query) override {
    checkBatch(name, rays, out, count, query);
    if (count == 0) return graph.skip(name, "no rays");
    const std::string kind = query == Query::Any ? "any" : "closest";
    ComputePass pass = graph.compute(name, "bvh/" + kind + (alpha_ ? "_alpha.comp" : ".comp"));
    pass.specialize("kStackSize", stackSize_)
        .specialize("kRaysPerThread", raysPerThread_)
        .bind("nodes", nodes_, Access::Read)
        .bind("triangles", triangles_, Access::Read)
        .bind("rays", rays, Access::Read)
        .bind("result", out, Access::Write)
        .push(count);
    if (alpha_) {
      pass.bind("uvs", gpuScene_.uvs, Access::Read)
          .bind("indices", gpuScene_.indices, Access::Read)
          .bind("materialIds", gpuScene_.materialIds, Access::Read)
          .bind("materials", gpuScene_.materials, Access::Read)
          .sample("textures", gpuScene_.textures);
    }
    const uint32_t perGroup = kGroup * raysPerThread_;
    const uint32_t groups = (count + perGroup - 1) / perGroup;
    const uint32_t rows = (groups + kMaxGroupsPerRow - 1) / kMaxGroupsPerRow;
    pass.dispatch((groups + rows - 1) / rows, rows);
  }

  std::vector<std::pair<std::string, uint64_t>> memory() const override {
    return {{"bvh: nodes", nodes_.size()}, {"bvh: triangles", triangles_.size()}};
  }

 private:
  const GpuScene gpuScene_;  // handles; the scene itself may have moved by the time rays are cast
  Buffer nodes_, triangles_;
  uint32_t stackSize_ = 1, raysPerThread_ = 1;
  bool alpha_ = false;
};

}  // namespace

std::unique_ptr<Tracer> makeBvhTracer(Device& device, const Scene& scene, const GpuScene& gpuScene, TaskPool& pool,
                                      Progress* progress) {
  return std::make_unique<BvhTracer>(device, scene, gpuScene, pool, progress);
}

}  // namespace hl
