// Running a batch: command buffers, barriers, labels, timestamps, and host passes between submissions.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>

#include "engine/core/log.h"
#include "engine/gpu/pass.h"

namespace hl {
namespace {

using Clock = std::chrono::steady_clock;
double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// What a host pass sees of its buffers.
class MappedBuffers final : public HostAccess {
 public:
  explicit MappedBuffers(const std::string& pass) : pass_(pass) {}
  void add(const Buffer& b, void* data) { mapped_.emplace_back(b.state(), data); }

 protected:
  void* map(const Buffer& b) override {
    for (const auto& [state, data] : mapped_) {
      if (state == b.state()) return data;
    }
    throw badInput(fmt::format("pass \"{}\": buffer \"{}\" is used without having been declared", pass_, b.name()));
  }

 private:
  const std::string& pass_;
  std::vector<std::pair<BufferState*, void*>> mapped_;
};

class Runner {
 public:
  explicit Runner(FrameGraph::Impl& graph) : graph_(graph), device_(*graph.device) {
    // llvmpipe bins a timestamp with what it draws, and runs it when that is flushed: behind the dispatch that it was written before.
    // Under validation they stay in one batch all the same: passes that are waited for hide missing barriers, and figures are not taken there.
    timestamps_ = device_.survey.timestampBits > 0 && (!device_.cpu || device_.instance->validation());
    timings_.serialised = device_.cpu;
  }

  BatchTimings run() {
    for (const Pass& pass : graph_.passes) {
      if (!pass.complete)
        throw badInput(fmt::format("pass \"{}\": recorded, but never dispatched, drawn or run", pass.name));
    }
    prepare();
    graph_.barriers.clear();
    for (size_t i = 0; i < graph_.passes.size(); ++i) {
      Pass& pass = graph_.passes[i];
      timings_.passes.push_back({pass.name, pass.kind == Pass::Kind::Host, 0, pass.creationMs, pass.skipped});
      if (pass.kind == Pass::Kind::Skipped) continue;
      if (pass.kind == Pass::Kind::Host) {
        host(i);
        continue;
      }
      // A CPU device charges consecutive raster passes of one command buffer to the wrong pass.
      const bool apart = !timestamps_ || (device_.cpu && pass.kind == Pass::Kind::Raster);
      if (apart) flush();
      begin();
      barriers(pass);
      const size_t range = open(i);
      record(pass);
      close(range);
      if (apart) {
        const Clock::time_point start = Clock::now();
        flush();
        if (!timestamps_) timings_.passes[i].ms = msSince(start);
      }
    }
    flush();
    collect();
    std::erase_if(graph_.stagings, [&](const Buffer& b) {
      return std::find(staged_.begin(), staged_.end(), b.state()) == staged_.end();
    });
    return std::move(timings_);
  }

 private:
  struct Range {
    size_t pass = 0;
    uint32_t query = 0;
  };
  static constexpr size_t kNoRange = ~size_t{0};

  void prepare() {
    VkDevice device = device_.device;
    if (graph_.commandPool == VK_NULL_HANDLE) {
      VkCommandPoolCreateInfo info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
      info.queueFamilyIndex = device_.survey.queueFamily;
      check(vkCreateCommandPool(device, &info, nullptr, &graph_.commandPool), "creating a command pool");
      VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
      allocate.commandPool = graph_.commandPool;
      allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
      allocate.commandBufferCount = 1;
      check(vkAllocateCommandBuffers(device, &allocate, &graph_.commands), "allocating a command buffer");
    }
    // A pass on the device takes one pair of timestamps; a staged host pass one pair before it and one after.
    const auto wanted = static_cast<uint32_t>(graph_.passes.size() * 4);
    if (timestamps_ && wanted > graph_.queryCapacity) {
      vkDestroyQueryPool(device, graph_.queries, nullptr);
      graph_.queries = VK_NULL_HANDLE;
      VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
      info.queryType = VK_QUERY_TYPE_TIMESTAMP;
      info.queryCount = graph_.queryCapacity = std::max(wanted, 64u);
      check(vkCreateQueryPool(device, &info, nullptr, &graph_.queries), "creating timestamp queries");
    }
  }

  void begin() {
    if (recording_) return;
    check(vkResetCommandPool(device_.device, graph_.commandPool, 0), "recording commands");
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(vkBeginCommandBuffer(graph_.commands, &info), "recording commands");
    recording_ = true;
    if (!queriesReset_ && timestamps_) {
      vkCmdResetQueryPool(graph_.commands, graph_.queries, 0, graph_.queryCapacity);
      queriesReset_ = true;
    }
  }

  /// Submits what is recorded and waits for it.
  void flush() {
    if (!recording_) return;
    check(vkEndCommandBuffer(graph_.commands), "recording commands");
    recording_ = false;
    if (!started_) start_ = Clock::now();
    started_ = true;
    device_.submit(graph_.commands);
    timings_.wallMs = msSince(start_);
  }

  size_t open(size_t pass) {
    if (device_.beginLabel != nullptr) {
      VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
      label.pLabelName = graph_.passes[pass].name.c_str();
      device_.beginLabel(graph_.commands, &label);
    }
    if (!timestamps_) return kNoRange;
    const auto query = static_cast<uint32_t>(ranges_.size() * 2);
    ranges_.push_back({pass, query});
    vkCmdWriteTimestamp2(graph_.commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, graph_.queries, query);
    return ranges_.size() - 1;
  }

  void close(size_t range) {
    if (range != kNoRange) {
      // Keeps the next pass from starting before this one's time is taken. Not under validation: it would order
      // everything, and so hide a missing barrier between passes from synchronisation validation.
      if (!device_.instance->validation()) {
        VkMemoryBarrier2 all{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
        all.srcStageMask = all.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
        VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
        info.memoryBarrierCount = 1;
        info.pMemoryBarriers = &all;
        vkCmdPipelineBarrier2(graph_.commands, &info);
      }
      vkCmdWriteTimestamp2(graph_.commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, graph_.queries,
                           ranges_[range].query + 1);
    }
    if (device_.endLabel != nullptr) device_.endLabel(graph_.commands);
  }

  void barriers(Pass& pass) {
    const bool omit = std::find(graph_.omitted.begin(), graph_.omitted.end(), pass.name) != graph_.omitted.end();
    std::vector<VkBufferMemoryBarrier2> buffers;
    std::vector<VkImageMemoryBarrier2> images;
    for (const auto& [buffer, use] : pass.buffers) {
      const Dependency d = nextUse(buffer.state()->history, use);
      if (d.hazard == nullptr || omit) continue;
      buffers.push_back(bufferBarrier(*buffer.state(), d));
      graph_.barriers.push_back({pass.name, buffer.name(), d.hazard});
    }
    for (const auto& [image, use] : pass.images) {
      const Dependency d = nextUse(image.state()->history, use);
      if (d.hazard == nullptr || (omit && d.oldLayout == d.newLayout)) continue;
      images.push_back(imageBarrier(*image.state(), d));
      graph_.barriers.push_back({pass.name, image.name(), d.hazard});
    }
    if (buffers.empty() && images.empty()) return;
    begin();
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.bufferMemoryBarrierCount = static_cast<uint32_t>(buffers.size());
    info.pBufferMemoryBarriers = buffers.data();
    info.imageMemoryBarrierCount = static_cast<uint32_t>(images.size());
    info.pImageMemoryBarriers = images.data();
    vkCmdPipelineBarrier2(graph_.commands, &info);
  }

  void record(const Pass& pass) {
    VkCommandBuffer c = graph_.commands;
    if (pass.kind == Pass::Kind::Transfer) {
      pass.transfer(c);
      return;
    }
    const bool raster = pass.kind == Pass::Kind::Raster, rays = pass.kind == Pass::Kind::Rays;
    const VkPipelineBindPoint point = raster ? VK_PIPELINE_BIND_POINT_GRAPHICS
                                      : rays ? VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR
                                             : VK_PIPELINE_BIND_POINT_COMPUTE;
    const Pipeline& pipeline = *pass.pipeline;
    vkCmdBindPipeline(c, point, pipeline.handle);
    vkCmdBindDescriptorSets(c, point, pipeline.layout, 0, static_cast<uint32_t>(pass.sets.size()), pass.sets.data(), 0,
                            nullptr);
    if (pipeline.pushBytes > 0 && !pass.push.empty()) {
      const auto bytes = std::min(pipeline.pushBytes, static_cast<uint32_t>(pass.push.size()));
      vkCmdPushConstants(c, pipeline.layout, pipeline.pushStages, 0, bytes, pass.push.data());
    }
    if (raster) {
      draw(pass);
      return;
    }
    if (rays) {
      const VkStridedDeviceAddressRegionKHR callable{};
      vkCmdTraceRaysKHR(c, &pipeline.generation, &pipeline.miss, &pipeline.hit, &callable, pass.size[0], pass.size[1], pass.size[2]);
      return;
    }
    const uint32_t limit = device_.survey.properties.limits.maxComputeWorkGroupCount[0];
    if (pass.size[0] <= limit) {
      vkCmdDispatch(c, pass.size[0], pass.size[1], pass.size[2]);
      return;
    }
    for (uint32_t first = 0; first < pass.size[0];) {
      const uint32_t count = std::min(limit, pass.size[0] - first);
      vkCmdDispatchBase(c, first, 0, 0, count, pass.size[1], pass.size[2]);
      first += count;
    }
  }

  void draw(const Pass& pass) {
    VkCommandBuffer c = graph_.commands;
    const GpuImage& sized = pass.targets.color.empty() ? pass.targets.depth : pass.targets.color[0];
    const VkExtent2D extent{static_cast<uint32_t>(sized.width()), static_cast<uint32_t>(sized.height())};
    std::vector<VkRenderingAttachmentInfo> color;
    for (const GpuImage& target : pass.targets.color) {
      VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
      info.imageView = target.state()->storage;
      info.imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
      info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
      info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
      color.push_back(info);
    }
    VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
    info.renderArea.extent = extent;
    info.layerCount = 1;
    info.colorAttachmentCount = static_cast<uint32_t>(color.size());
    info.pColorAttachments = color.data();
    if (pass.targets.depth) {
      depth.imageView = pass.targets.depth.state()->storage;
      depth.imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
      depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
      depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
      info.pDepthAttachment = &depth;
    }
    vkCmdBeginRendering(c, &info);
    const VkViewport viewport{0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
    const VkRect2D scissor{{0, 0}, extent};
    vkCmdSetViewport(c, 0, 1, &viewport);
    vkCmdSetScissor(c, 0, 1, &scissor);
    vkCmdDraw(c, pass.size[0], pass.size[1], 0, 0);
    vkCmdEndRendering(c);
  }

  Buffer staging(uint64_t bytes) {
    for (const Buffer& b : graph_.stagings) {
      if (b.size() >= bytes && std::find(staged_.begin(), staged_.end(), b.state()) == staged_.end()) {
        staged_.push_back(b.state());
        return b;
      }
    }
    graph_.stagings.push_back(device_.makeBuffer("host pass staging", bytes, TexelFormat::None, MemoryUse::Readback));
    staged_.push_back(graph_.stagings.back().state());
    return graph_.stagings.back();
  }

  /// Copies staged buffers in (before the host pass) or out (after it), as the pass `index`'s own work.
  void copyStaged(size_t index, const std::vector<std::pair<Use<Buffer>, Buffer>>& staged, bool toHost) {
    if (staged.empty()) return;
    begin();
    Pass copies;
    copies.name = graph_.passes[index].name;
    for (const auto& [use, host] : staged) {
      copies.use(use.resource, toHost ? kTransferRead : kTransferWrite);
      copies.use(host, toHost ? kTransferWrite : kTransferRead);
    }
    barriers(copies);
    const size_t range = open(index);
    for (const auto& [use, host] : staged) {
      const VkBuffer device = use.resource.state()->handle, other = host.state()->handle;
      const VkBufferCopy region{0, 0, use.resource.size()};
      vkCmdCopyBuffer(graph_.commands, toHost ? device : other, toHost ? other : device, 1, &region);
    }
    close(range);
  }

  void host(size_t index) {
    Pass& pass = graph_.passes[index];
    MappedBuffers access(pass.name);
    std::vector<std::pair<Use<Buffer>, Buffer>> in, out;
    Pass visible;  // what the host touches in place
    visible.name = pass.name;
    for (const auto& use : pass.buffers) {
      BufferState& state = *use.resource.state();
      if (state.mapped != nullptr) {
        visible.use(use.resource, use.use);
        access.add(use.resource, state.mapped);
        continue;
      }
      const Buffer copy = staging(state.size);
      access.add(use.resource, copy.state()->mapped);
      // A pass that writes may write only a part: the rest must come back as it was.
      in.emplace_back(use, copy);
      if (use.use.writes != 0) out.emplace_back(use, copy);
      visible.use(copy, use.use);
    }
    const Clock::time_point before = Clock::now();
    copyStaged(index, in, true);
    barriers(visible);
    flush();
    if (!timestamps_) timings_.passes[index].ms += msSince(before);
    if (!started_) start_ = Clock::now();
    started_ = true;
    const Clock::time_point start = Clock::now();
    pass.run(access);
    timings_.passes[index].ms += msSince(start);
    timings_.wallMs = msSince(start_);
    copyStaged(index, out, false);
  }

  void collect() {
    if (ranges_.empty()) return;
    std::vector<uint64_t> ticks(ranges_.size() * 2);
    check(vkGetQueryPoolResults(device_.device, graph_.queries, 0, static_cast<uint32_t>(ticks.size()),
                                ticks.size() * 8, ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
          "reading timestamps");
    const uint32_t bits = device_.survey.timestampBits;
    const uint64_t mask = bits >= 64 ? ~0ull : (1ull << bits) - 1;
    for (const Range& r : ranges_) {
      const uint64_t elapsed = (ticks[r.query + 1] - ticks[r.query]) & mask;
      timings_.passes[r.pass].ms +=
          static_cast<double>(elapsed) * static_cast<double>(device_.survey.properties.limits.timestampPeriod) * 1e-6;
    }
  }

  FrameGraph::Impl& graph_;
  Device::Impl& device_;
  BatchTimings timings_;
  bool timestamps_ = false, recording_ = false, queriesReset_ = false, started_ = false;
  Clock::time_point start_;
  std::vector<Range> ranges_;
  std::vector<BufferState*> staged_;  ///< staging buffers in use
};

}  // namespace

BatchTimings runBatch(FrameGraph::Impl& graph) { return Runner(graph).run(); }

}  // namespace hl
