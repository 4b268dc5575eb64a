#include "engine/gpu/device.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "engine/gpu/device_impl.h"

namespace hl {
namespace {

int rank(const DeviceInfo& info) {
  const char* order[] = {"discrete", "integrated", "virtual", "cpu"};
  return static_cast<int>(std::find(std::begin(order), std::end(order), info.type) - std::begin(order));
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

DeviceSurvey choose(const std::vector<DeviceSurvey>& all, const std::string& select) {
  std::string list;
  for (size_t i = 0; i < all.size(); ++i) {
    list += fmt::format("{}{} \"{}\" ({}{})", i == 0 ? "" : ", ", i, all[i].info.name, all[i].info.type,
                        all[i].info.missing.empty() ? "" : ", lacks " + all[i].info.missing);
  }
  const DeviceSurvey* best = nullptr;
  const bool number = !select.empty() &&
                      std::all_of(select.begin(), select.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  for (size_t i = 0; i < all.size(); ++i) {
    const DeviceSurvey& s = all[i];
    if (number) {
      if (select != std::to_string(i)) continue;
    } else if (lower(s.info.name).find(lower(select)) == std::string::npos) {
      continue;
    }
    // An unusable device never wins over a usable one.
    const auto order = [](const DeviceSurvey& d) { return std::pair(!d.info.missing.empty(), rank(d.info)); };
    if (best == nullptr || order(s) < order(*best)) best = &s;
  }
  if (best == nullptr) throw badInput(fmt::format("no device matches \"{}\"; there are {}", select, list));
  if (!best->info.missing.empty()) {
    throw Error(ErrorKind::Device,
                fmt::format("device \"{}\" lacks {}; there are {}", best->info.name, best->info.missing, list));
  }
  return *best;
}

}  // namespace

std::vector<DeviceInfo> listDevices() {
  const Instance instance(false);
  std::vector<DeviceInfo> infos;
  for (VkPhysicalDevice d : instance.physicalDevices()) infos.push_back(survey(d).info);
  return infos;
}

Device::Impl::Impl(const DeviceOptions& options) {
  const char* variable = std::getenv("HALFLIGHT_VALIDATION");
  const bool wanted = variable != nullptr && *variable != '\0' && std::strcmp(variable, "0") != 0;
  instance = std::make_shared<Instance>(options.validation || wanted);
  std::vector<DeviceSurvey> all;
  for (VkPhysicalDevice d : instance->physicalDevices()) all.push_back(hl::survey(d));
  survey = choose(all, options.select);
  cpu = survey.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;

  const float priority = 1;
  VkDeviceQueueCreateInfo queueInfo{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queueInfo.queueFamilyIndex = survey.queueFamily;
  queueInfo.queueCount = 1;
  queueInfo.pQueuePriorities = &priority;

  std::vector<const char*> extensions;
  VkPhysicalDeviceShaderAtomicFloatFeaturesEXT atomics{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_FLOAT_FEATURES_EXT};
  atomics.shaderBufferFloat32Atomics = atomics.shaderBufferFloat32AtomicAdd = VK_TRUE;
  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  v13.dynamicRendering = v13.synchronization2 = v13.maintenance4 = VK_TRUE;
  if (survey.floatAtomics) {
    extensions.push_back(VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME);
    v13.pNext = &atomics;
  }
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rays{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  rays.rayTracingPipeline = VK_TRUE;
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  structures.accelerationStructure = VK_TRUE;
  if (survey.rayPipelines) {
    extensions.insert(extensions.end(), std::begin(kRayExtensions), std::end(kRayExtensions));
    rays.pNext = &structures, structures.pNext = v13.pNext, v13.pNext = &rays;
  }
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  v12.pNext = &v13;
  v12.scalarBlockLayout = VK_TRUE;
  v12.bufferDeviceAddress = survey.rayPipelines ? VK_TRUE : VK_FALSE;
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  features.pNext = &v12;
  features.features.vertexPipelineStoresAndAtomics = features.features.fragmentStoresAndAtomics = VK_TRUE;
  features.features.shaderStorageImageExtendedFormats = VK_TRUE;

  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.pNext = &features;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queueInfo;
  if (!instance->surfaces())
    noPresentation = "the Vulkan loader has no surfaces on X windows (VK_KHR_xcb_surface)";
  else if (!survey.swapchains)
    noPresentation = survey.info.name + " has no swapchains (VK_KHR_swapchain)";
  else
    extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(vkCreateDevice(survey.handle, &info, nullptr, &device), "opening " + survey.info.name);
  vkGetDeviceQueue(device, survey.queueFamily, 0, &queue);
  const bool shared =
      !options.staging && (cpu || survey.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU);
  hostVisible = shared;
  memory = std::make_unique<DeviceMemory>(survey.handle, device, shared, survey.rayPipelines);

  if (instance->debugLabels()) {
    const auto get = [&](const char* f) { return vkGetInstanceProcAddr(instance->handle(), f); };
    beginLabel = reinterpret_cast<PFN_vkCmdBeginDebugUtilsLabelEXT>(get("vkCmdBeginDebugUtilsLabelEXT"));
    endLabel = reinterpret_cast<PFN_vkCmdEndDebugUtilsLabelEXT>(get("vkCmdEndDebugUtilsLabelEXT"));
    setName = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(get("vkSetDebugUtilsObjectNameEXT"));
  }

  VkCommandPoolCreateInfo poolInfo{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  poolInfo.queueFamilyIndex = survey.queueFamily;
  check(vkCreateCommandPool(device, &poolInfo, nullptr, &pool_), "creating a command pool");
  VkCommandBufferAllocateInfo commandInfo{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  commandInfo.commandPool = pool_;
  commandInfo.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  commandInfo.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(device, &commandInfo, &commands_), "allocating a command buffer");
  const VkFenceCreateInfo fenceInfo{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(device, &fenceInfo, nullptr, &fence_), "creating a fence");

  VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler.magFilter = sampler.minFilter = VK_FILTER_LINEAR;
  sampler.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  sampler.maxLod = VK_LOD_CLAMP_NONE;
  sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  check(vkCreateSampler(device, &sampler, nullptr, &clampSampler), "creating a sampler");
  VkSamplerCreateInfo nearest = sampler;
  nearest.magFilter = nearest.minFilter = VK_FILTER_NEAREST;
  nearest.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  check(vkCreateSampler(device, &nearest, nullptr, &nearestSampler), "creating a sampler");
  sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  check(vkCreateSampler(device, &sampler, nullptr, &repeatSampler), "creating a sampler");
}

Device::Impl::~Impl() {
  if (device == VK_NULL_HANDLE) return;
  vkDeviceWaitIdle(device);
  for (VkSampler s : {clampSampler, repeatSampler, nearestSampler}) vkDestroySampler(device, s, nullptr);
  vkDestroyFence(device, fence_, nullptr);
  vkDestroyCommandPool(device, pool_, nullptr);
  memory.reset();
  vkDestroyDevice(device, nullptr);
}

void Device::Impl::name(VkObjectType type, uint64_t handle, const std::string& text) const {
  if (setName == nullptr) return;
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = text.c_str();
  setName(device, &info);
}

void Device::Impl::submit(VkCommandBuffer commands) {
  std::lock_guard lock(queueMutex_);
  VkCommandBufferSubmitInfo commandInfo{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  commandInfo.commandBuffer = commands;
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commandInfo;
  check(vkQueueSubmit2(queue, 1, &info, fence_), survey.info.name);
  check(vkWaitForFences(device, 1, &fence_, VK_TRUE, UINT64_MAX), survey.info.name);
  check(vkResetFences(device, 1, &fence_), survey.info.name);
}

VkResult Device::Impl::onQueue(const std::function<VkResult(VkQueue)>& call) {
  std::lock_guard lock(queueMutex_);
  return call(queue);
}

void Device::Impl::once(const std::function<void(VkCommandBuffer)>& record) {
  std::lock_guard lock(onceMutex_);
  check(vkResetCommandPool(device, pool_, 0), "resetting a command pool");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  check(vkBeginCommandBuffer(commands_, &begin), "recording commands");
  record(commands_);
  check(vkEndCommandBuffer(commands_), "recording commands");
  submit(commands_);
}

Device::Device(const DeviceOptions& options) : impl_(std::make_shared<Impl>(options)) {}
Device::~Device() = default;

const DeviceInfo& Device::info() const { return impl_->survey.info; }
bool Device::isCpu() const { return impl_->cpu; }
bool Device::timestampsSupported() const { return impl_->survey.timestampBits > 0; }
bool Device::rayPipelines() const { return impl_->survey.rayPipelines; }
uint64_t Device::maxStorageBufferBytes() const { return impl_->survey.properties.limits.maxStorageBufferRange; }
uint32_t Device::maxTexelBufferElements() const { return impl_->survey.properties.limits.maxTexelBufferElements; }
uint64_t Device::validationMessages() const { return impl_->instance->log().count(); }
std::vector<std::string> Device::takeValidationMessages() { return impl_->instance->log().take(); }
uint64_t Device::bytesAllocated() const { return impl_->memory->bytesAllocated(); }

void Device::waitIdle() {
  check(impl_->onQueue([&](VkQueue) { return vkDeviceWaitIdle(impl_->device); }), impl_->survey.info.name);
}

Buffer Device::buffer(const std::string& name, uint64_t bytes, TexelFormat texels) {
  return impl_->makeBuffer(name, bytes, texels, MemoryUse::Device);
}

GpuImage Device::image(const std::string& name, const ImageDesc& desc) { return impl_->makeImage(name, desc); }

}  // namespace hl
