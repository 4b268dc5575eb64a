#include "engine/gpu/pass.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "engine/gpu/acceleration_impl.h"

namespace hl {
namespace {

constexpr uint64_t kUniformChunk = 256 << 10;
constexpr uint32_t kSetsPerPool = 128;

VkPipelineStageFlags2 stageFlags(VkShaderStageFlagBits stage) {
  switch (stage) {
    case VK_SHADER_STAGE_VERTEX_BIT:
      return VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT;
    case VK_SHADER_STAGE_FRAGMENT_BIT:
      return VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
    case VK_SHADER_STAGE_RAYGEN_BIT_KHR:
    case VK_SHADER_STAGE_MISS_BIT_KHR:
    case VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR:
    case VK_SHADER_STAGE_ANY_HIT_BIT_KHR:
      return VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
    default:
      return VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  }
}

/// Every read that a shader can make, so that one barrier serves all ways of binding the resource in that stage.
constexpr VkAccessFlags2 kShaderReads =
    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT;

ResourceUse shaderUse(VkShaderStageFlagBits stage, Access access, VkImageLayout layout) {
  ResourceUse use;
  use.stages = stageFlags(stage);
  if (access != Access::Write) use.reads = kShaderReads;
  if (access != Access::Read) use.writes = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  use.layout = layout;
  return use;
}

struct Resolver {
  Pass& pass;
  Device::Impl& device;
  std::vector<bool> matched = std::vector<bool>(pass.bindings.size(), false);

  Error fail(const Shader& shader, const std::string& binding, const std::string& why) const {
    return badInput(fmt::format("pass \"{}\", shader {}, binding \"{}\": {}", pass.name, shader.name, binding, why));
  }

  const BoundResource& find(const Shader& shader, const ShaderBinding& b) {
    const BoundResource* found = nullptr;
    for (size_t i = 0; i < pass.bindings.size(); ++i) {
      if (!b.answersTo(pass.bindings[i].name)) continue;
      if (found != nullptr) throw fail(shader, pass.bindings[i].name, "bound twice");
      found = &pass.bindings[i];
      matched[i] = true;
    }
    if (found == nullptr) {
      std::vector<std::string> bound;
      for (const BoundResource& r : pass.bindings) bound.push_back(r.name);
      const std::string near = nearest(b.names.front(), bound);
      throw fail(shader, b.names.front(),
                 "nothing is bound to it" + (near.empty() ? "" : "; is \"" + near + "\" meant for it?"));
    }
    return *found;
  }

  bool buffer(const Shader& shader, const ShaderBinding& b, const BoundResource& r, VkDescriptorBufferInfo& info) {
    const BufferState& state = *r.buffer.state();
    const VkPhysicalDeviceLimits& limits = device.survey.properties.limits;
    const bool uniform = b.kind == BindingKind::UniformBlock;
    if (b.kind != BindingKind::StorageBuffer && !uniform) return false;
    if (r.uniformBytes > 0) {
      if (!uniform) throw fail(shader, r.name, fmt::format("is {}, not a uniform block", kindName(b.kind)));
      if (r.uniformBytes < b.blockBytes || r.uniformBytes > (b.blockBytes + 15) / 16 * 16) {
        throw fail(shader, r.name,
                   fmt::format("the block has {} bytes, and {} are given", b.blockBytes, r.uniformBytes));
      }
      info = {state.handle, r.uniformOffset, r.uniformBytes};
      return true;
    }
    const uint64_t largest = uniform ? limits.maxUniformBufferRange : limits.maxStorageBufferRange;
    if (state.size > largest) {
      throw Error(ErrorKind::TooLarge,
                  fmt::format("pass \"{}\", binding \"{}\": buffer \"{}\" has {} bytes, and {} binds at most {}",
                              pass.name, r.name, state.name, state.size, device.survey.info.name, largest));
    }
    info = {state.handle, 0, VK_WHOLE_SIZE};
    if (uniform && r.access != Access::Read) throw fail(shader, r.name, "a uniform block is only read");
    pass.use(r.buffer, shaderUse(shader.stage, r.access, VK_IMAGE_LAYOUT_UNDEFINED));
    return true;
  }

  bool image(const Shader& shader, const ShaderBinding& b, const BoundResource& r, VkDescriptorImageInfo& info) {
    const ImageState& state = *r.image.state();
    if (r.sampled ? b.kind != BindingKind::SampledImage : b.kind != BindingKind::StorageImage) return false;
    if (r.sampled) {
      const VkImageView view = b.arrayed ? state.sampledArray : state.sampled;
      if (view == VK_NULL_HANDLE) {
        throw fail(
            shader, r.name,
            fmt::format("image \"{}\" has {} layers and is sampled as a single one", state.name, state.desc.layers));
      }
      const bool nearestFilter = b.integer || !state.filterable;
      info.sampler = nearestFilter ? device.nearestSampler : b.arrayed ? device.repeatSampler : device.clampSampler;
      info.imageView = view;
      // An image that is sampled and stored to by one pass stays in the one layout that allows both.
      const bool stored = std::any_of(pass.bindings.begin(), pass.bindings.end(),
                                      [&](const auto& o) { return !o.sampled && o.image.state() == r.image.state(); });
      info.imageLayout = stored ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    } else {
      if ((state.usage & VK_IMAGE_USAGE_STORAGE_BIT) == 0) {
        throw fail(shader, r.name,
                   fmt::format("{} images cannot be stored to here", formatInfo(state.desc.format).name));
      }
      if (b.arrayed != (state.desc.layers > 1)) {
        throw fail(shader, r.name,
                   fmt::format("image \"{}\" has {} layers, the shader {}", state.name, state.desc.layers,
                               b.arrayed ? "wants an array" : "wants one"));
      }
      info.imageView = state.storage;
      info.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
    }
    pass.use(r.image, shaderUse(shader.stage, r.access, info.imageLayout));
    return true;
  }

  void stage(const Shader& shader, VkDescriptorSet set) {
    const auto& all = shader.reflection.bindings;
    std::vector<VkWriteDescriptorSet> writes;
    std::vector<VkDescriptorBufferInfo> bufferInfos(all.size());
    std::vector<VkDescriptorImageInfo> imageInfos(all.size());
    std::vector<VkWriteDescriptorSetAccelerationStructureKHR> structures(all.size());
    for (size_t i = 0; i < all.size(); ++i) {
      const ShaderBinding& b = all[i];
      if (!b.used) {
        // Declared (by an include, say) and never reached: it may be bound, and need not.
        for (size_t j = 0; j < pass.bindings.size(); ++j) {
          if (b.answersTo(pass.bindings[j].name)) matched[j] = true;
        }
        continue;
      }
      const BoundResource& r = find(shader, b);
      if (!r.buffer && !r.image && !r.acceleration) throw fail(shader, r.name, "an empty resource is bound to it");
      VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
      write.dstSet = set;
      write.dstBinding = b.index;
      write.descriptorCount = 1;
      write.descriptorType = descriptorType(b.kind);
      bool fits = false;
      if (r.acceleration) {
        // Built before any graph could bind it, and never changed: nothing to wait for.
        fits = b.kind == BindingKind::AccelerationStructure;
        structures[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR};
        structures[i].accelerationStructureCount = 1;
        structures[i].pAccelerationStructures = &r.acceleration.state()->top.handle;
        write.pNext = &structures[i];
      } else if (r.image) {
        fits = image(shader, b, r, imageInfos[i]);
        write.pImageInfo = &imageInfos[i];
      } else if (b.kind == BindingKind::TexelBuffer && r.uniformBytes == 0) {
        if (r.buffer.state()->texels == VK_NULL_HANDLE) {
          throw fail(
              shader, r.name,
              fmt::format("is a texel buffer, and buffer \"{}\" was made without a texel format", r.buffer.name()));
        }
        write.pTexelBufferView = &r.buffer.state()->texels;
        pass.use(r.buffer, shaderUse(shader.stage, Access::Read, VK_IMAGE_LAYOUT_UNDEFINED));
        fits = true;
      } else {
        fits = buffer(shader, b, r, bufferInfos[i]);
        write.pBufferInfo = &bufferInfos[i];
      }
      if (!fits) {
        throw fail(shader, r.name,
                   fmt::format("is {}, and {} is bound to it", kindName(b.kind),
                               r.acceleration ? "an acceleration structure" : r.image ? r.sampled ? "a sampled image" : "an image for storing" : "a buffer"));
      }
      writes.push_back(write);
    }
    vkUpdateDescriptorSets(device.device, static_cast<uint32_t>(writes.size()), writes.data(), 0, nullptr);
  }

  void checkLeftOver() const {
    for (size_t i = 0; i < matched.size(); ++i) {
      if (matched[i]) continue;
      std::vector<std::string> known;
      std::string shaders;
      for (const auto& shader : pass.shaders) {
        shaders += (shaders.empty() ? "" : ", ") + shader->name;
        for (const ShaderBinding& b : shader->reflection.bindings)
          known.insert(known.end(), b.names.begin(), b.names.end());
      }
      const std::string near = nearest(pass.bindings[i].name, known);
      throw badInput(fmt::format("pass \"{}\", shader {}, binding \"{}\": the shader has no such binding{}", pass.name,
                                 shaders, pass.bindings[i].name, near.empty() ? "" : "; is it \"" + near + "\"?"));
    }
  }

  void checkConstants() const {
    for (const auto& [name, value] : pass.constants) {
      std::vector<std::string> known;
      for (const auto& shader : pass.shaders) {
        for (const auto& [constant, id] : shader->reflection.constants) known.push_back(constant);
      }
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      const std::string near = nearest(name, known);
      throw badInput(fmt::format("pass \"{}\", shader {}: no specialisation constant \"{}\"{}", pass.name,
                                 pass.shaders[0]->name, name, near.empty() ? "" : "; is it \"" + near + "\"?"));
    }
    for (const auto& shader : pass.shaders) {
      const uint64_t bytes = shader->reflection.pushBytes;
      const bool fits = pass.push.size() >= bytes &&
                        (bytes == 0 || pass.shaders.size() > 1 || pass.push.size() <= (bytes + 15) / 16 * 16);
      if (fits || !shader->reflection.pushUsed) continue;
      throw badInput(fmt::format("pass \"{}\", shader {}: push constants have {} bytes, and {} are given", pass.name,
                                 shader->name, bytes, pass.push.size()));
    }
    const bool declared = std::any_of(pass.shaders.begin(), pass.shaders.end(),
                                      [](const auto& s) { return s->reflection.pushBytes > 0; });
    if (!pass.push.empty() && !declared) {
      throw badInput(fmt::format("pass \"{}\", shader {}: it has no push constants", pass.name, pass.shaders[0]->name));
    }
  }
};

}  // namespace

void Pass::use(const Buffer& buffer, const ResourceUse& u) {
  for (auto& known : buffers) {
    if (known.resource.state() != buffer.state()) continue;
    known.use.stages |= u.stages, known.use.reads |= u.reads, known.use.writes |= u.writes;
    return;
  }
  buffers.push_back({buffer, u});
}

void Pass::use(const GpuImage& image, const ResourceUse& u) {
  for (auto& known : images) {
    if (known.resource.state() != image.state()) continue;
    if (known.use.layout != u.layout) {
      throw badInput(fmt::format("pass \"{}\": image \"{}\" is drawn into and bound as well", name, image.name()));
    }
    known.use.stages |= u.stages, known.use.reads |= u.reads, known.use.writes |= u.writes;
    return;
  }
  images.push_back({image, u});
}

void resolve(Pass& pass, PipelineCache& pipelines, BatchArena& arena, Device::Impl& device) {
  Resolver resolver{pass, device};
  resolver.checkConstants();
  PipelineRequest request;
  request.shaders = pass.shaders;
  request.constants = pass.constants;
  request.dispatchBase =
      pass.kind == Pass::Kind::Compute && pass.size[0] > device.survey.properties.limits.maxComputeWorkGroupCount[0];
  for (const GpuImage& target : pass.targets.color) {
    const VkFormat ofWindow = target.state()->windowFormat;
    request.color.push_back(ofWindow != VK_FORMAT_UNDEFINED ? ofWindow : formatInfo(target.format()).vk);
  }
  if (pass.targets.depth) request.depth = formatInfo(pass.targets.depth.format()).vk;
  bool created = false;
  pass.pipeline = pipelines.get(request, pass.name, &created);
  if (created) pass.creationMs = pass.pipeline->creationMs;

  for (VkDescriptorSetLayout layout : pass.pipeline->sets) pass.sets.push_back(arena.set(layout));
  for (const auto& shader : pass.shaders) resolver.stage(*shader, pass.sets[shader->reflection.set]);
  resolver.checkLeftOver();
  if (pass.kind != Pass::Kind::Raster) return;
  for (const GpuImage& target : pass.targets.color) {
    pass.use(target, {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, 0, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                      VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL});
  }
  if (pass.targets.depth) {
    pass.use(pass.targets.depth,
             {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
              VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
              VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL});
  }
}

BatchArena::~BatchArena() {
  for (VkDescriptorPool p : pools_) vkDestroyDescriptorPool(device_->device, p, nullptr);
}

Buffer BatchArena::copy(const void* data, size_t bytes, uint64_t* offset) {
  const uint64_t alignment = device_->survey.properties.limits.minUniformBufferOffsetAlignment;
  uint64_t begin = (uniformUsed_ + alignment - 1) / alignment * alignment;
  while (currentUniform_ < uniforms_.size() && begin + bytes > uniforms_[currentUniform_].size())
    ++currentUniform_, begin = 0;
  if (currentUniform_ == uniforms_.size()) {
    uniforms_.push_back(device_->makeBuffer("uniform blocks", std::max<uint64_t>(kUniformChunk, bytes),
                                            TexelFormat::None, MemoryUse::Upload));
    begin = 0;
  }
  const Buffer& buffer = uniforms_[currentUniform_];
  std::memcpy(static_cast<char*>(buffer.state()->mapped) + begin, data, bytes);
  uniformUsed_ = begin + bytes;
  *offset = begin;
  return buffer;
}

VkDescriptorSet BatchArena::set(VkDescriptorSetLayout layout) {
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  for (; currentPool_ < pools_.size(); ++currentPool_) {
    info.descriptorPool = pools_[currentPool_];
    if (vkAllocateDescriptorSets(device_->device, &info, &set) == VK_SUCCESS) return set;
  }
  std::vector<VkDescriptorPoolSize> sizes = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsPerPool * 12},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, kSetsPerPool * 4},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, kSetsPerPool * 8},
                                        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kSetsPerPool * 8},
                                        {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kSetsPerPool * 4}};
  if (device_->survey.rayPipelines) sizes.push_back({VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, kSetsPerPool});
  VkDescriptorPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  poolInfo.maxSets = kSetsPerPool;
  poolInfo.poolSizeCount = static_cast<uint32_t>(sizes.size());
  poolInfo.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(device_->device, &poolInfo, nullptr, &pool), "creating a descriptor pool");
  pools_.push_back(pool);
  info.descriptorPool = pool;
  check(vkAllocateDescriptorSets(device_->device, &info, &set), "allocating descriptors");
  return set;
}

void BatchArena::reset() {
  for (VkDescriptorPool p : pools_) vkResetDescriptorPool(device_->device, p, 0);
  currentPool_ = currentUniform_ = 0;
  uniformUsed_ = 0;
}

}  // namespace hl
