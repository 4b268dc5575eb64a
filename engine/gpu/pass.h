#pragma once
// A pass between its recording and its execution.
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/pipelines.h"

namespace hl {

struct BoundResource {
  std::string name;
  Buffer buffer;  ///< or
  GpuImage image;                          ///< or
  AccelerationStructure acceleration;
  Access access = Access::Read;
  bool sampled = false;
  uint64_t uniformBytes = 0, uniformOffset = 0;  ///< a uniform block copied into `buffer`
};

template <class Handle>
struct Use {
  Handle resource;
  ResourceUse use;
};

struct Pass {
  enum class Kind { Compute, Raster, Rays, Host, Transfer, Skipped };
  Kind kind = Kind::Compute;
  std::string name;
  bool complete = false;  ///< dispatched, drawn, or given what to run

  // As recorded.
  std::vector<std::shared_ptr<const Shader>> shaders;
  std::vector<BoundResource> bindings;
  std::map<std::string, uint32_t> constants;
  std::vector<std::byte> push;
  uint32_t size[3] = {1, 1, 1};  ///< groups; or vertices and instances; or rays
  RasterTargets targets;
  std::function<void(HostAccess&)> run;
  std::function<void(VkCommandBuffer)> transfer;
  std::string skipped;

  // As resolved against the shaders.
  std::shared_ptr<Pipeline> pipeline;
  std::vector<VkDescriptorSet> sets;
  std::vector<Use<Buffer>> buffers;
  std::vector<Use<GpuImage>> images;
  double creationMs = 0;

  void use(const Buffer&, const ResourceUse&);
  /// @throws Error(BadInput) where one pass needs the image in ways that exclude each other.
  void use(const GpuImage&, const ResourceUse&);
};

/// Descriptor sets and uniform blocks of one batch; empty again after it.
class BatchArena {
 public:
  explicit BatchArena(std::shared_ptr<Device::Impl> device) : device_(std::move(device)) {}
  ~BatchArena();
  BatchArena(const BatchArena&) = delete;
  BatchArena& operator=(const BatchArena&) = delete;
  /// Copies a block; returns its buffer, and where in it the copy lies.
  Buffer copy(const void* data, size_t bytes, uint64_t* offset);
  VkDescriptorSet set(VkDescriptorSetLayout);
  void reset();

 private:
  std::shared_ptr<Device::Impl> device_;
  std::vector<Buffer> uniforms_;
  size_t currentUniform_ = 0;
  uint64_t uniformUsed_ = 0;
  std::vector<VkDescriptorPool> pools_;
  size_t currentPool_ = 0;
};

/// Checks a pass against its shaders and gives it pipeline, descriptor sets and uses.
/// @throws Error(BadInput) naming pass, shader and binding; Error(TooLarge) where a resource is larger than the device
/// can bind.
void resolve(Pass&, PipelineCache&, BatchArena&, Device::Impl&);

struct FrameGraph::Impl {
  Impl(Device& d, ShaderLibrary& s)
      : device(d.impl().shared_from_this()), shaders(s), pipelines(device), arena(device) {}
  ~Impl();

  Pass& add(Pass::Kind, const std::string& name);
  Pass& at(size_t index) { return passes.at(index); }
  /// Resolves a pass; where it fails, the batch is dropped.
  void finish(Pass&);
  void drop();

  std::shared_ptr<Device::Impl> device;
  ShaderLibrary& shaders;
  PipelineCache pipelines;
  BatchArena arena;
  std::vector<Pass> passes;
  std::vector<BarrierRecord> barriers;
  std::vector<std::string> omitted;
  std::map<std::string, std::pair<ImageDesc, GpuImage>> historyImages, transientImages;
  std::map<std::string, Buffer> historyBuffers, transientBuffers;

  // Of runBatch, kept from batch to batch.
  VkCommandPool commandPool = VK_NULL_HANDLE;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkQueryPool queries = VK_NULL_HANDLE;
  uint32_t queryCapacity = 0;
  std::vector<Buffer> stagings;
};

/// Runs the passes in order, with barriers, labels and timestamps round each.
BatchTimings runBatch(FrameGraph::Impl&);

}  // namespace hl
