// Rays cast by compute shaders over a tree in texel buffers.
#include <algorithm>
#include <string>

#include "engine/core/error.h"
#include "engine/trace/alpha_test.h"
#include "engine/trace/backends.h"
#include "engine/scene/scene_pose.h"
#include "engine/trace/bvh.h"
#include "engine/trace/bvh_refit.h"

namespace hl {
namespace {

constexpr uint32_t kGroup = 64;  // local_size_x of shaders/bvh/traverse.glsl
/// On a CPU, where eight rays walk in step, threads that take several in turn keep all eight busy: 1.2 times the rate
/// on Sponza for the closest hit, 1.6 times for any hit. Elsewhere many threads are worth more.
constexpr uint32_t kRaysPerThreadOnCpu = 16;
constexpr uint64_t kCheckEvery = 16;  // updates between two looks at how good a refitted tree still is: each waits for the device
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
      : device_(device), scene_(scene), pool_(pool), gpuScene_(gpuScene), tested_(alphaTestedTriangles(scene)), moving_(movingTriangles(scene)) {
    raysPerThread_ = device.isCpu() ? kRaysPerThreadOnCpu : 1;
    build(progress);
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

  void recordUpdate(FrameGraph& graph) override {
    if (refit_.triangles.empty()) return;
    struct {
      uint32_t first, count, all;
    } level{0, 0, static_cast<uint32_t>(refit_.nodes.size())};
    const auto moved = static_cast<uint32_t>(refit_.triangles.size());
    graph.compute("bvh: move triangles", "bvh/move_triangles.comp")
        .bind("moved", moved_, Access::Read)
        .bind("indices", gpuScene_.indices, Access::Read)
        .bind("positions", gpuScene_.positions, Access::Read)
        .bind("triangles", triangles_, Access::ReadWrite)
        .push(moved)
        .dispatchThreads(moved);
    for (const uint32_t end : refit_.levels) {
      level.count = end - level.first;
      graph.compute("bvh: refit", "bvh/refit.comp")
          .bind("refitNodes", refitNodes_, Access::Read)
          .bind("triangles", triangles_, Access::Read)
          .bind("nodes", nodes_, Access::ReadWrite)
          .bind("areas", areas_, Access::Write)
          .push(level)
          .dispatchThreads(level.count);
      level.first = end;
    }
    // By the number of updates, so that runs with the same frames have the same trees.
    if (++updates_ % kCheckEvery != 0) return;
    graph.host("bvh: check and rebuild").read(areas_).run([this, areas = areas_](HostAccess& memory) {
      const std::span<const float> list = memory.span<float>(areas);
      const double cost = costAfterRefit(refit_, list.first(refit_.nodes.size()), list[refit_.nodes.size()]);
      // Rays recorded before this go through the old tree, which is right, only slow.
      if (cost > kBvhWorn * refit_.builtCost) build(nullptr);
    });
  }

  std::vector<std::pair<std::string, uint64_t>> memory() const override {
    const uint64_t lists = moving_.empty() ? 0 : moved_.size() + refitNodes_.size() + areas_.size();
    return {{"bvh: nodes", nodes_.size()}, {"bvh: triangles", triangles_.size()}, {"bvh: refit lists", lists}};
  }

 private:
  /// Over the scene as it is posed now.
  void build(Progress* progress) {
    const Bvh bvh = buildBvh(scene_, tested_, pool_, progress);
    alpha_ = !tested_.empty();
    stackSize_ = bvh.stackSize;
    nodes_ = texels(device_, "bvh: nodes", bvh.nodes);
    triangles_ = texels(device_, "bvh: triangles", bvh.triangles);
    refit_ = planRefit(bvh, moving_);
    if (refit_.triangles.empty()) return;
    moved_ = device_.buffer("bvh: moved", std::span<const uint32_t>(refit_.triangles));
    refitNodes_ = device_.buffer("bvh: refit nodes", std::span<const uint32_t>(refit_.nodes));
    areas_ = device_.buffer("bvh: areas", (refit_.nodes.size() + 1) * sizeof(float));
  }

  Device& device_;
  const Scene& scene_;       // read again only where a tree over moving objects is built anew
  TaskPool& pool_;
  const GpuScene gpuScene_;  // handles; the scene itself may have moved by the time rays are cast
  const std::vector<bool> tested_, moving_;
  Buffer nodes_, triangles_, moved_, refitNodes_, areas_;
  BvhRefit refit_;
  uint64_t updates_ = 0;
  uint32_t stackSize_ = 1, raysPerThread_ = 1;
  bool alpha_ = false;
};

}  // namespace

std::unique_ptr<Tracer> makeBvhTracer(Device& device, const Scene& scene, const GpuScene& gpuScene, TaskPool& pool,
                                      Progress* progress) {
  return std::make_unique<BvhTracer>(device, scene, gpuScene, pool, progress);
}

}  // namespace hl
