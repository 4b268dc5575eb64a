#include "engine/gpu/resources.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/gpu/device_impl.h"

namespace hl {

const FormatInfo& formatInfo(Format format) {
  static constexpr FormatInfo table[] = {
      {"R32F", VK_FORMAT_R32_SFLOAT, 4, 1, true, false},
      {"RG32F", VK_FORMAT_R32G32_SFLOAT, 8, 2, true, false},
      {"RGBA32F", VK_FORMAT_R32G32B32A32_SFLOAT, 16, 4, true, false},
      {"RGBA16F", VK_FORMAT_R16G16B16A16_SFLOAT, 8, 4, true, false},
      {"RGBA8", VK_FORMAT_R8G8B8A8_UNORM, 4, 4, false, false},
      {"R32U", VK_FORMAT_R32_UINT, 4, 1, false, true},
      {"RG32U", VK_FORMAT_R32G32_UINT, 8, 2, false, true},
      {"RGBA32U", VK_FORMAT_R32G32B32A32_UINT, 16, 4, false, true},
      {"D32F", VK_FORMAT_D32_SFLOAT, 4, 1, true, false},
  };
  return table[static_cast<size_t>(format)];
}

Buffer Device::Impl::makeBuffer(const std::string& name, uint64_t bytes, TexelFormat texels, MemoryUse use) {
  if (bytes == 0) throw badInput(fmt::format("buffer \"{}\": a size of 0 bytes", name));
  if (bytes > survey.maxBufferSize) {
    throw Error(ErrorKind::TooLarge, fmt::format("buffer \"{}\": {} bytes, and {} takes at most {} in one buffer", name,
                                               bytes, survey.info.name, survey.maxBufferSize));
  }
  auto state = std::make_shared<BufferState>();
  state->device = shared_from_this();
  state->name = name;
  state->size = bytes;

  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = bytes;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
               VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (texels != TexelFormat::None) info.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
  if (survey.rayPipelines)
    info.usage |= VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
                  VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR | VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR;
  const std::string what = fmt::format("buffer \"{}\" of {} bytes", name, bytes);
  check(vkCreateBuffer(device, &info, nullptr, &state->handle), what);
  this->name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(state->handle), name);
  VkMemoryRequirements need{};
  vkGetBufferMemoryRequirements(device, state->handle, &need);
  state->allocation = memory->allocate(need, use, false, what);
  check(vkBindBufferMemory(device, state->handle, state->allocation.memory(), state->allocation.offset), what);
  if (use != MemoryUse::Device || hostVisible) state->mapped = state->allocation.mapped();

  if (texels != TexelFormat::None) {
    const uint64_t texelBytes = 16;
    if (bytes % texelBytes != 0) throw badInput(what + ": not a whole number of RGBA32F texels");
    if (bytes / texelBytes > survey.properties.limits.maxTexelBufferElements) {
      throw Error(ErrorKind::TooLarge, fmt::format("{}: {} takes at most {} texels in one buffer", what, survey.info.name,
                                                 survey.properties.limits.maxTexelBufferElements));
    }
    VkBufferViewCreateInfo view{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
    view.buffer = state->handle;
    view.format = VK_FORMAT_R32G32B32A32_SFLOAT;
    view.range = bytes;
    check(vkCreateBufferView(device, &view, nullptr, &state->texels), what);
  }
  return Buffer(std::move(state));
}

GpuImage Device::Impl::makeImage(const std::string& name, const ImageDesc& desc) {
  const FormatInfo& format = formatInfo(desc.format);
  const std::string what =
      fmt::format("image \"{}\" of {}x{}x{} {} texels", name, desc.width, desc.height, desc.layers, format.name);
  const VkPhysicalDeviceLimits& limits = survey.properties.limits;
  if (desc.width < 1 || desc.height < 1 || desc.layers < 1 || desc.mips < 1) throw badInput(what + ": an empty image");
  if (static_cast<uint32_t>(std::max(desc.width, desc.height)) > limits.maxImageDimension2D ||
      static_cast<uint32_t>(desc.layers) > limits.maxImageArrayLayers) {
    throw Error(ErrorKind::TooLarge,
                fmt::format("{}: {} takes at most {} texels a side and {} layers", what, survey.info.name,
                            limits.maxImageDimension2D, limits.maxImageArrayLayers));
  }
  auto state = std::make_shared<ImageState>();
  state->device = shared_from_this();
  state->name = name;
  state->desc = desc;

  VkFormatProperties features{};
  vkGetPhysicalDeviceFormatProperties(survey.handle, format.vk, &features);
  const bool depth = desc.format == Format::D32F;
  VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  const std::pair<VkFormatFeatureFlags, VkImageUsageFlags> wanted[] = {
      {VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT, VK_IMAGE_USAGE_SAMPLED_BIT},
      {VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT, VK_IMAGE_USAGE_STORAGE_BIT},
      {VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT},
      {VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT},
  };
  for (const auto& [feature, flag] : wanted) {
    if ((features.optimalTilingFeatures & feature) != 0 && !(depth && flag == VK_IMAGE_USAGE_STORAGE_BIT))
      usage |= flag;
  }
  state->usage = usage;
  state->filterable = (features.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;

  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format.vk;
  info.extent = {static_cast<uint32_t>(desc.width), static_cast<uint32_t>(desc.height), 1};
  info.mipLevels = static_cast<uint32_t>(desc.mips);
  info.arrayLayers = static_cast<uint32_t>(desc.layers);
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage;
  check(vkCreateImage(device, &info, nullptr, &state->handle), what);
  this->name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(state->handle), name);
  VkMemoryRequirements need{};
  vkGetImageMemoryRequirements(device, state->handle, &need);
  state->allocation = memory->allocate(need, MemoryUse::Device, true, what);
  check(vkBindImageMemory(device, state->handle, state->allocation.memory(), state->allocation.offset), what);

  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = state->handle;
  view.format = format.vk;
  view.subresourceRange = state->range();
  if (desc.layers == 1) {
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    check(vkCreateImageView(device, &view, nullptr, &state->sampled), what);
  }
  view.viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY;
  check(vkCreateImageView(device, &view, nullptr, &state->sampledArray), what);
  view.viewType = desc.layers == 1 ? VK_IMAGE_VIEW_TYPE_2D : VK_IMAGE_VIEW_TYPE_2D_ARRAY;
  view.subresourceRange.levelCount = 1;
  check(vkCreateImageView(device, &view, nullptr, &state->storage), what);
  return GpuImage(std::move(state));
}

BufferState::~BufferState() {
  if (device == nullptr) return;
  if (texels != VK_NULL_HANDLE) vkDestroyBufferView(device->device, texels, nullptr);
  vkDestroyBuffer(device->device, handle, nullptr);
  device->memory->release(allocation);
}

ImageState::~ImageState() {
  if (device == nullptr) return;
  for (VkImageView v : {sampled, sampledArray, storage}) vkDestroyImageView(device->device, v, nullptr);
  if (ofSwapchain) return;
  vkDestroyImage(device->device, handle, nullptr);
  device->memory->release(allocation);
}

VkImageSubresourceRange ImageState::range() const {
  const VkImageAspectFlags aspect = desc.format == Format::D32F ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  return {aspect, 0, static_cast<uint32_t>(desc.mips), 0, static_cast<uint32_t>(desc.layers)};
}

VkBufferMemoryBarrier2 bufferBarrier(const BufferState& b, const Dependency& d) {
  VkBufferMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2};
  barrier.srcStageMask = d.sourceStages;
  barrier.srcAccessMask = d.sourceAccess;
  barrier.dstStageMask = d.destinationStages;
  barrier.dstAccessMask = d.destinationAccess;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.buffer = b.handle;
  barrier.size = VK_WHOLE_SIZE;
  return barrier;
}

VkImageMemoryBarrier2 imageBarrier(const ImageState& i, const Dependency& d) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = d.sourceStages;
  barrier.srcAccessMask = d.sourceAccess;
  barrier.dstStageMask = d.destinationStages;
  barrier.dstAccessMask = d.destinationAccess;
  barrier.oldLayout = d.oldLayout;
  barrier.newLayout = d.newLayout;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = i.handle;
  barrier.subresourceRange = i.range();
  return barrier;
}

void transition(VkCommandBuffer commands, BufferState& b, const ResourceUse& use) {
  const Dependency d = nextUse(b.history, use);
  if (d.hazard == nullptr) return;
  const VkBufferMemoryBarrier2 barrier = bufferBarrier(b, d);
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.bufferMemoryBarrierCount = 1;
  info.pBufferMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

void transition(VkCommandBuffer commands, ImageState& i, const ResourceUse& use) {
  const Dependency d = nextUse(i.history, use);
  if (d.hazard == nullptr) return;
  const VkImageMemoryBarrier2 barrier = imageBarrier(i, d);
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

uint64_t Buffer::size() const { return state_ == nullptr ? 0 : state_->size; }
const std::string& Buffer::name() const {
  static const std::string none = "(none)";
  return state_ == nullptr ? none : state_->name;
}

int GpuImage::width() const { return state_ == nullptr ? 0 : state_->desc.width; }
int GpuImage::height() const { return state_ == nullptr ? 0 : state_->desc.height; }
Format GpuImage::format() const { return state_ == nullptr ? Format::RGBA32F : state_->desc.format; }
const std::string& GpuImage::name() const {
  static const std::string none = "(none)";
  return state_ == nullptr ? none : state_->name;
}

}  // namespace hl
