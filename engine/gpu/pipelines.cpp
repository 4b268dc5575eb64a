#include "engine/gpu/pipelines.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>

namespace hl {
namespace {

std::string keyOf(const PipelineRequest& r) {
  std::string key;
  for (const auto& shader : r.shaders) key += fmt::format("{};", shader->version);
  for (const auto& [name, value] : r.constants) key += fmt::format("{}={};", name, value);
  for (const VkFormat f : r.color) key += fmt::format("c{};", static_cast<int>(f));
  return key + fmt::format("d{};b{}", static_cast<int>(r.depth), r.dispatchBase ? 1 : 0);
}

struct Specialization {
  std::vector<VkSpecializationMapEntry> entries;
  std::vector<uint32_t> values;
  VkSpecializationInfo info{};

  Specialization(const Shader& shader, const std::map<std::string, uint32_t>& constants) {
    for (const auto& [name, value] : constants) {
      const auto it = shader.reflection.constants.find(name);
      if (it == shader.reflection.constants.end()) continue;
      entries.push_back({it->second, static_cast<uint32_t>(values.size() * 4), 4});
      values.push_back(value);
    }
    info = {static_cast<uint32_t>(entries.size()), entries.data(), values.size() * 4, values.data()};
  }
};

VkPipelineShaderStageCreateInfo stageInfo(const Shader& shader, const Specialization& s) {
  VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage = shader.stage;
  info.module = shader.module;
  info.pName = "main";
  info.pSpecializationInfo = s.entries.empty() ? nullptr : &s.info;
  return info;
}

}  // namespace

VkDescriptorType descriptorType(BindingKind kind) {
  switch (kind) {
    case BindingKind::StorageBuffer:
      return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case BindingKind::UniformBlock:
      return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case BindingKind::StorageImage:
      return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case BindingKind::SampledImage:
      return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    case BindingKind::TexelBuffer:
      return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case BindingKind::AccelerationStructure:
      return VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
  }
  return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

Pipeline::~Pipeline() {
  if (device == nullptr) return;
  vkDestroyPipeline(device->device, handle, nullptr);
  vkDestroyPipelineLayout(device->device, layout, nullptr);
  for (VkDescriptorSetLayout s : sets) vkDestroyDescriptorSetLayout(device->device, s, nullptr);
}

PipelineCache::PipelineCache(std::shared_ptr<Device::Impl> device) : device_(std::move(device)) {
  const VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  check(vkCreatePipelineCache(device_->device, &info, nullptr, &cache_), "creating a pipeline cache");
}

PipelineCache::~PipelineCache() {
  pipelines_.clear();
  vkDestroyPipelineCache(device_->device, cache_, nullptr);
}

std::shared_ptr<Pipeline> PipelineCache::get(const PipelineRequest& request, const std::string& pass, bool* created) {
  const std::string key = keyOf(request);
  const auto it = pipelines_.find(key);
  *created = it == pipelines_.end();
  if (!*created) return it->second;

  // Pipelines of a shader's earlier versions are of no more use.
  std::erase_if(pipelines_, [&](const auto& entry) {
    return std::any_of(entry.second->shaders.begin(), entry.second->shaders.end(), [&](const auto& old) {
      return std::any_of(request.shaders.begin(), request.shaders.end(),
                         [&](const auto& s) { return s->name == old->name && s->version > old->version; });
    });
  });
  const auto start = std::chrono::steady_clock::now();
  auto pipeline = make(request, pass);
  pipeline->creationMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  pipelines_.emplace(key, pipeline);
  return pipeline;
}

/// One ray generation shader, one miss shader, one hit group for triangles.
void PipelineCache::makeRayPipeline(Pipeline& pipeline, const PipelineRequest& request, const std::string& pass) {
  const std::vector<Specialization> constants = [&] {
    std::vector<Specialization> all;
    all.reserve(request.shaders.size());  // stageInfo keeps pointers into them
    for (const auto& shader : request.shaders) all.emplace_back(*shader, request.constants);
    return all;
  }();
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  VkRayTracingShaderGroupCreateInfoKHR none{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR};
  none.type = VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR;
  none.generalShader = none.closestHitShader = none.anyHitShader = none.intersectionShader = VK_SHADER_UNUSED_KHR;
  VkRayTracingShaderGroupCreateInfoKHR groups[3] = {none, none, none};  // generation, miss, hit
  groups[2].type = VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR;
  for (size_t i = 0; i < request.shaders.size(); ++i) {
    stages.push_back(stageInfo(*request.shaders[i], constants[i]));
    const auto index = static_cast<uint32_t>(i);
    switch (request.shaders[i]->stage) {
      case VK_SHADER_STAGE_RAYGEN_BIT_KHR:
        groups[0].generalShader = index;
        break;
      case VK_SHADER_STAGE_MISS_BIT_KHR:
        groups[1].generalShader = index;
        break;
      case VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR:
        groups[2].closestHitShader = index;
        break;
      default:
        groups[2].anyHitShader = index;
    }
  }
  VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  info.groupCount = static_cast<uint32_t>(std::size(groups));
  info.pGroups = groups;
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = pipeline.layout;
  check(vkCreateRayTracingPipelinesKHR(device_->device, VK_NULL_HANDLE, cache_, 1, &info, nullptr, &pipeline.handle), pass);

  const auto& properties = device_->survey.rayProperties;
  const uint32_t handle = properties.shaderGroupHandleSize;
  const auto aligned = [](uint64_t value, uint64_t to) { return (value + to - 1) / to * to; };
  const uint64_t record = aligned(handle, properties.shaderGroupBaseAlignment);
  std::vector<char> handles(std::size(groups) * handle);
  check(vkGetRayTracingShaderGroupHandlesKHR(device_->device, pipeline.handle, 0, info.groupCount, handles.size(), handles.data()), pass);
  const uint64_t bytes = (std::size(groups) + 1) * record;  // one more, so that the first can be aligned
  pipeline.table = device_->makeBuffer(pass + ": shader binding table", bytes, TexelFormat::None, MemoryUse::Device);
  const uint64_t address = device_->address(pipeline.table), first = aligned(address, properties.shaderGroupBaseAlignment);
  const Buffer staging = device_->makeBuffer("shader binding table staging", bytes, TexelFormat::None, MemoryUse::Upload);
  for (size_t i = 0; i < std::size(groups); ++i)
    std::copy_n(handles.data() + i * handle, handle, static_cast<char*>(staging.state()->mapped) + (first - address) + i * record);
  device_->once([&](VkCommandBuffer commands) {
    const VkBufferCopy region{0, 0, bytes};
    vkCmdCopyBuffer(commands, staging.state()->handle, pipeline.table.state()->handle, 1, &region);
    VkMemoryBarrier2 written{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    written.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT, written.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    written.dstStageMask = VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR;
    written.dstAccessMask = VK_ACCESS_2_SHADER_BINDING_TABLE_READ_BIT_KHR;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &written;
    vkCmdPipelineBarrier2(commands, &dependency);
  });
  pipeline.generation = {first, record, record};
  pipeline.miss = {first + record, record, record};
  pipeline.hit = {first + 2 * record, record, record};
}

std::shared_ptr<Pipeline> PipelineCache::make(const PipelineRequest& request, const std::string& pass) {
  auto pipeline = std::make_shared<Pipeline>();
  VkDevice device = device_->device;
  pipeline->device = device_;
  pipeline->shaders = request.shaders;
  for (const auto& shader : request.shaders) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (const ShaderBinding& b : shader->reflection.bindings) {
      if (b.used)
        bindings.push_back(
            {b.index, descriptorType(b.kind), 1, static_cast<VkShaderStageFlags>(shader->stage), nullptr});
    }
    VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    info.bindingCount = static_cast<uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    // A stage that is left out leaves an empty set behind.
    for (VkDescriptorSetLayoutCreateInfo none{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO}; pipeline->sets.size() <= shader->reflection.set;) {
      pipeline->sets.push_back(VK_NULL_HANDLE);
      const bool own = pipeline->sets.size() == shader->reflection.set + 1;
      check(vkCreateDescriptorSetLayout(device, own ? &info : &none, nullptr, &pipeline->sets.back()), pass);
    }
    if (shader->reflection.pushBytes > 0) {
      pipeline->pushStages |= static_cast<VkShaderStageFlags>(shader->stage);
      const auto bytes = static_cast<uint32_t>((shader->reflection.pushBytes + 3) / 4 * 4);
      pipeline->pushBytes = std::max(pipeline->pushBytes, bytes);
    }
  }
  const VkPushConstantRange push{pipeline->pushStages, 0, pipeline->pushBytes};
  VkPipelineLayoutCreateInfo layoutInfo{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layoutInfo.setLayoutCount = static_cast<uint32_t>(pipeline->sets.size());
  layoutInfo.pSetLayouts = pipeline->sets.data();
  layoutInfo.pushConstantRangeCount = pipeline->pushBytes > 0 ? 1 : 0;
  layoutInfo.pPushConstantRanges = &push;
  check(vkCreatePipelineLayout(device, &layoutInfo, nullptr, &pipeline->layout), pass);

  const Specialization first(*request.shaders[0], request.constants);
  if (request.shaders[0]->stage == VK_SHADER_STAGE_RAYGEN_BIT_KHR) {
    makeRayPipeline(*pipeline, request, pass);
  } else if (request.shaders.size() == 1) {
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.flags = request.dispatchBase ? static_cast<VkPipelineCreateFlags>(VK_PIPELINE_CREATE_DISPATCH_BASE_BIT) : 0u;
    info.stage = stageInfo(*request.shaders[0], first);
    info.layout = pipeline->layout;
    check(vkCreateComputePipelines(device, cache_, 1, &info, nullptr, &pipeline->handle), pass);
  } else {
    const Specialization second(*request.shaders[1], request.constants);
    const VkPipelineShaderStageCreateInfo stages[] = {stageInfo(*request.shaders[0], first),
                                                      stageInfo(*request.shaders[1], second)};
    const VkPipelineVertexInputStateCreateInfo vertices{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo rasterization{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    rasterization.polygonMode = VK_POLYGON_MODE_FILL;
    rasterization.cullMode = VK_CULL_MODE_NONE;
    rasterization.lineWidth = 1;
    VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = depth.depthWriteEnable = request.depth == VK_FORMAT_UNDEFINED ? VK_FALSE : VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_GREATER;
    VkPipelineColorBlendAttachmentState attachment{};
    attachment.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    const std::vector<VkPipelineColorBlendAttachmentState> attachments(request.color.size(), attachment);
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = static_cast<uint32_t>(attachments.size());
    blend.pAttachments = attachments.data();
    const VkDynamicState states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = states;
    VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
    rendering.colorAttachmentCount = static_cast<uint32_t>(request.color.size());
    rendering.pColorAttachmentFormats = request.color.data();
    rendering.depthAttachmentFormat = request.depth;

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.pNext = &rendering;
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &vertices;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &rasterization;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = pipeline->layout;
    check(vkCreateGraphicsPipelines(device, cache_, 1, &info, nullptr, &pipeline->handle), pass);
  }
  device_->name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline->handle), pass);
  return pipeline;
}

}  // namespace hl
