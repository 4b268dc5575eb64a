#include "engine/gpu/frame_graph.h"

#include <fmt/core.h>

#include <cstring>

#include "engine/gpu/acceleration_impl.h"
#include "engine/gpu/pass.h"

namespace hl {
namespace {

constexpr ResourceUse kHostUses[] = {
    {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED},
    {VK_PIPELINE_STAGE_2_HOST_BIT, 0, VK_ACCESS_2_HOST_WRITE_BIT, VK_IMAGE_LAYOUT_UNDEFINED},
    {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, VK_ACCESS_2_HOST_WRITE_BIT, VK_IMAGE_LAYOUT_UNDEFINED},
};

void declare(Pass& pass, const Buffer& b, Access access) {
  if (!b) throw badInput(fmt::format("pass \"{}\": an empty buffer is declared", pass.name));
  pass.use(b, kHostUses[static_cast<size_t>(access)]);
}

BoundResource bound(const char* name, const Buffer& b, Access access) {
  BoundResource r;
  r.name = name, r.buffer = b, r.access = access;
  return r;
}

BoundResource bound(const char* name, const GpuImage& i, Access access, bool sampled) {
  BoundResource r;
  r.name = name, r.image = i, r.access = access, r.sampled = sampled;
  return r;
}

void setPush(Pass& pass, const void* data, size_t size) {
  const auto* bytes = static_cast<const std::byte*>(data);
  pass.push.assign(bytes, bytes + size);
}

VkImageCopy wholeImage(const ImageState& s) {
  VkImageCopy region{};
  region.srcSubresource = region.dstSubresource = {s.range().aspectMask, 0, 0, static_cast<uint32_t>(s.desc.layers)};
  region.extent = {static_cast<uint32_t>(s.desc.width), static_cast<uint32_t>(s.desc.height), 1};
  return region;
}

void clearImage(VkCommandBuffer commands, const ImageState& s) {
  const VkImageSubresourceRange range = s.range();
  if (s.desc.format == Format::D32F) {
    const VkClearDepthStencilValue zero{};
    vkCmdClearDepthStencilImage(commands, s.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &zero, 1, &range);
  } else {
    const VkClearColorValue zero{};
    vkCmdClearColorImage(commands, s.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &zero, 1, &range);
  }
}

}  // namespace

ComputePass& ComputePass::bind(const char* name, const Buffer& b, Access access) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, b, access));
  return *this;
}
ComputePass& ComputePass::bind(const char* name, const GpuImage& i, Access access) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, i, access, false));
  return *this;
}
ComputePass& ComputePass::sample(const char* name, const GpuImage& i) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, i, Access::Read, true));
  return *this;
}
ComputePass& ComputePass::uniformBytes(const char* name, const void* data, size_t size) {
  BoundResource r = bound(name, Buffer(), Access::Read);
  r.buffer = graph_->impl_->arena.copy(data, size, &r.uniformOffset);
  r.uniformBytes = size;
  graph_->impl_->at(index_).bindings.push_back(std::move(r));
  return *this;
}
ComputePass& ComputePass::pushBytes(const void* data, size_t size) {
  setPush(graph_->impl_->at(index_), data, size);
  return *this;
}
ComputePass& ComputePass::specialize(const char* name, uint32_t value) {
  graph_->impl_->at(index_).constants[name] = value;
  return *this;
}

void ComputePass::dispatch(uint32_t x, uint32_t y, uint32_t z) {
  Pass& pass = graph_->impl_->at(index_);
  const uint32_t* limit = graph_->impl_->device->survey.properties.limits.maxComputeWorkGroupCount;
  if (y > limit[1] || z > limit[2]) {
    const Error e = badInput(fmt::format("pass \"{}\": {} x {} x {} groups; along y and z at most {} and {}", pass.name,
                                         x, y, z, limit[1], limit[2]));
    graph_->impl_->drop();
    throw e;
  }
  pass.size[0] = x, pass.size[1] = y, pass.size[2] = z;
  graph_->impl_->finish(pass);
}

void ComputePass::dispatchThreads(uint32_t x, uint32_t y, uint32_t z) {
  const Pass& pass = graph_->impl_->at(index_);
  const ShaderReflection& r = pass.shaders[0]->reflection;
  const uint32_t threads[3] = {x, y, z};
  uint32_t groups[3];
  for (size_t i = 0; i < 3; ++i) {
    uint32_t size = r.groupSize[i];
    if (const auto it = pass.constants.find(r.groupSizeConstant[i]); it != pass.constants.end()) size = it->second;
    groups[i] = threads[i] / size + (threads[i] % size != 0 ? 1 : 0);
  }
  dispatch(groups[0], groups[1], groups[2]);
}

RasterPass& RasterPass::bind(const char* name, const Buffer& b, Access access) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, b, access));
  return *this;
}
RasterPass& RasterPass::sample(const char* name, const GpuImage& i) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, i, Access::Read, true));
  return *this;
}
RasterPass& RasterPass::pushBytes(const void* data, size_t size) {
  setPush(graph_->impl_->at(index_), data, size);
  return *this;
}
RasterPass& RasterPass::specialize(const char* name, uint32_t value) {
  graph_->impl_->at(index_).constants[name] = value;
  return *this;
}
void RasterPass::draw(uint32_t vertices, uint32_t instances) {
  Pass& pass = graph_->impl_->at(index_);
  pass.size[0] = vertices, pass.size[1] = instances;
  graph_->impl_->finish(pass);
}

RayPass& RayPass::bind(const char* name, const Buffer& b, Access access) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, b, access));
  return *this;
}
RayPass& RayPass::bind(const char* name, const AccelerationStructure& a) {
  BoundResource r;
  r.name = name, r.acceleration = a;
  graph_->impl_->at(index_).bindings.push_back(std::move(r));
  return *this;
}
RayPass& RayPass::sample(const char* name, const GpuImage& i) {
  graph_->impl_->at(index_).bindings.push_back(bound(name, i, Access::Read, true));
  return *this;
}
RayPass& RayPass::pushBytes(const void* data, size_t size) {
  setPush(graph_->impl_->at(index_), data, size);
  return *this;
}
RayPass& RayPass::specialize(const char* name, uint32_t value) {
  graph_->impl_->at(index_).constants[name] = value;
  return *this;
}
void RayPass::launch(uint32_t width, uint32_t height) {
  Pass& pass = graph_->impl_->at(index_);
  const uint32_t most = graph_->impl_->device->survey.rayProperties.maxRayDispatchInvocationCount;
  if (uint64_t{width} * height > most) {
    const Error e(ErrorKind::TooLarge, fmt::format("pass \"{}\": {} x {} rays; the device launches {} at once", pass.name, width, height, most));
    graph_->impl_->drop();
    throw e;
  }
  pass.size[0] = width, pass.size[1] = height;
  graph_->impl_->finish(pass);
}

HostPass& HostPass::read(const Buffer& b) {
  declare(graph_->impl_->at(index_), b, Access::Read);
  return *this;
}
HostPass& HostPass::write(const Buffer& b) {
  declare(graph_->impl_->at(index_), b, Access::Write);
  return *this;
}
HostPass& HostPass::readWrite(const Buffer& b) {
  declare(graph_->impl_->at(index_), b, Access::ReadWrite);
  return *this;
}
void HostPass::run(std::function<void(HostAccess&)> body) {
  Pass& pass = graph_->impl_->at(index_);
  pass.run = std::move(body);
  pass.complete = true;
}

FrameGraph::Impl::~Impl() {
  vkDestroyQueryPool(device->device, queries, nullptr);
  vkDestroyCommandPool(device->device, commandPool, nullptr);
}

Pass& FrameGraph::Impl::add(Pass::Kind kind, const std::string& name) {
  passes.emplace_back();
  passes.back().kind = kind;
  passes.back().name = name;
  return passes.back();
}

void FrameGraph::Impl::finish(Pass& pass) {
  try {
    resolve(pass, pipelines, arena, *device);
    pass.complete = true;
  } catch (...) {
    drop();
    throw;
  }
}

void FrameGraph::Impl::drop() {
  passes.clear();
  omitted.clear();
  arena.reset();
}

FrameGraph::FrameGraph(Device& device, ShaderLibrary& shaders) : impl_(std::make_unique<Impl>(device, shaders)) {}
FrameGraph::~FrameGraph() = default;

ComputePass FrameGraph::compute(const std::string& name, const std::string& shader) {
  auto found = impl_->shaders.impl().find(shader);
  impl_->add(Pass::Kind::Compute, name).shaders = {std::move(found)};
  ComputePass pass;
  pass.graph_ = this, pass.index_ = impl_->passes.size() - 1;
  return pass;
}

RasterPass FrameGraph::raster(const std::string& name, const std::string& vertexShader,
                              const std::string& fragmentShader, const RasterTargets& targets) {
  auto vertex = impl_->shaders.impl().find(vertexShader), fragment = impl_->shaders.impl().find(fragmentShader);
  for (const GpuImage& target : targets.color) {
    if (target.width() != targets.color[0].width() || target.height() != targets.color[0].height()) {
      throw badInput(fmt::format("pass \"{}\": its targets differ in size", name));
    }
  }
  Pass& added = impl_->add(Pass::Kind::Raster, name);
  added.shaders = {std::move(vertex), std::move(fragment)};
  added.targets = targets;
  RasterPass pass;
  pass.graph_ = this, pass.index_ = impl_->passes.size() - 1;
  return pass;
}

RayPass FrameGraph::rays(const std::string& name, const RayShaders& shaders) {
  if (!impl_->device->survey.rayPipelines)
    throw Error(ErrorKind::Device, fmt::format("pass \"{}\": {} has no ray tracing pipelines", name, impl_->device->survey.info.name));
  std::vector<std::shared_ptr<const Shader>> found;
  for (const std::string& shader : {shaders.generation, shaders.miss, shaders.closestHit, shaders.anyHit})
    if (!shader.empty()) found.push_back(impl_->shaders.impl().find(shader));
  impl_->add(Pass::Kind::Rays, name).shaders = std::move(found);
  RayPass pass;
  pass.graph_ = this, pass.index_ = impl_->passes.size() - 1;
  return pass;
}

HostPass FrameGraph::host(const std::string& name) {
  impl_->add(Pass::Kind::Host, name);
  HostPass pass;
  pass.graph_ = this, pass.index_ = impl_->passes.size() - 1;
  return pass;
}

void FrameGraph::clear(const std::string& name, const Buffer& buffer, uint32_t value) {
  if (!buffer) throw badInput(fmt::format("pass \"{}\": an empty buffer is cleared", name));
  Pass& pass = impl_->add(Pass::Kind::Transfer, name);
  pass.use(buffer, kTransferWrite);
  pass.transfer = [buffer, value](VkCommandBuffer commands) {
    vkCmdFillBuffer(commands, buffer.state()->handle, 0, VK_WHOLE_SIZE, value);
  };
  pass.complete = true;
}

void FrameGraph::clear(const std::string& name, const GpuImage& image) {
  if (!image) throw badInput(fmt::format("pass \"{}\": an empty image is cleared", name));
  Pass& pass = impl_->add(Pass::Kind::Transfer, name);
  pass.use(image, kImageTransferWrite);
  pass.transfer = [image](VkCommandBuffer commands) { clearImage(commands, *image.state()); };
  pass.complete = true;
}

void FrameGraph::copy(const std::string& name, const GpuImage& from, const GpuImage& to) {
  if (!from || !to) throw badInput(fmt::format("pass \"{}\": an empty image is copied", name));
  const ImageDesc &a = from.state()->desc, &b = to.state()->desc;
  if (a.width != b.width || a.height != b.height || a.format != b.format || a.layers != b.layers) {
    throw badInput(
        fmt::format("pass \"{}\": images \"{}\" and \"{}\" differ in size or format", name, from.name(), to.name()));
  }
  Pass& pass = impl_->add(Pass::Kind::Transfer, name);
  pass.use(from, kImageTransferRead);
  pass.use(to, kImageTransferWrite);
  pass.transfer = [from, to](VkCommandBuffer commands) {
    const VkImageCopy region = wholeImage(*from.state());
    vkCmdCopyImage(commands, from.state()->handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.state()->handle,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  };
  pass.complete = true;
}

void FrameGraph::update(const std::string& name, const AccelerationStructure& structure) {
  if (!structure || !structure.state()->movingVertices) throw badInput(fmt::format("pass \"{}\": a structure that nothing moves in is updated", name));
  Pass& pass = impl_->add(Pass::Kind::Transfer, name);
  pass.use(structure.state()->movingVertices,
           {VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, VK_ACCESS_2_SHADER_READ_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED});
  pass.transfer = [structure](VkCommandBuffer commands) { recordUpdate(commands, *structure.state()); };
  pass.complete = true;
}

void FrameGraph::skip(const std::string& name, const std::string& reason) {
  Pass& pass = impl_->add(Pass::Kind::Skipped, name);
  pass.skipped = reason;
  pass.complete = true;
}

GpuImage FrameGraph::history(const std::string& name, const ImageDesc& desc, bool* fresh) {
  auto& [known, image] = impl_->historyImages[name];
  const bool make = !image || known != desc;
  if (make) {
    image = {};  // freed before its successor is made
    image = impl_->device->makeImage(name, desc);
    known = desc;
    impl_->device->once([&](VkCommandBuffer commands) {
      transition(commands, *image.state(), kImageTransferWrite);
      clearImage(commands, *image.state());
    });
  }
  if (fresh != nullptr) *fresh = make;
  return image;
}

Buffer FrameGraph::historyBuffer(const std::string& name, uint64_t bytes, bool* fresh) {
  Buffer& buffer = impl_->historyBuffers[name];
  const bool make = !buffer || buffer.size() != bytes;
  if (make) {
    buffer = {};
    buffer = impl_->device->makeBuffer(name, bytes, TexelFormat::None, MemoryUse::Device);
    impl_->device->once([&](VkCommandBuffer commands) {
      transition(commands, *buffer.state(), kTransferWrite);
      vkCmdFillBuffer(commands, buffer.state()->handle, 0, VK_WHOLE_SIZE, 0);
    });
  }
  if (fresh != nullptr) *fresh = make;
  return buffer;
}

void FrameGraph::resetHistory(const std::string& prefix) {
  std::erase_if(impl_->historyImages, [&](const auto& entry) { return entry.first.starts_with(prefix); });
  std::erase_if(impl_->historyBuffers, [&](const auto& entry) { return entry.first.starts_with(prefix); });
}

GpuImage FrameGraph::transient(const std::string& name, const ImageDesc& desc) {
  auto& [known, image] = impl_->transientImages[name];
  if (!image || known != desc) {
    image = {};
    image = impl_->device->makeImage(name, desc);
    known = desc;
  }
  return image;
}

Buffer FrameGraph::transientBuffer(const std::string& name, uint64_t bytes) {
  Buffer& buffer = impl_->transientBuffers[name];
  if (!buffer || buffer.size() != bytes) {
    buffer = {};
    buffer = impl_->device->makeBuffer(name, bytes, TexelFormat::None, MemoryUse::Device);
  }
  return buffer;
}

BatchTimings FrameGraph::execute() {
  const struct Drop {
    Impl& impl;
    ~Drop() { impl.drop(); }
  } drop{*impl_};
  return runBatch(*impl_);
}

void FrameGraph::drop() { impl_->drop(); }
const std::vector<BarrierRecord>& FrameGraph::barriers() const { return impl_->barriers; }
void FrameGraph::omitBarriersBefore(const std::string& pass) { impl_->omitted.push_back(pass); }

}  // namespace hl
