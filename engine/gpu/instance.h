#pragma once
// The Vulkan instance with its validation layers, and what is known about each physical device.
#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "engine/gpu/device.h"
#include "engine/gpu/vulkan.h"

namespace hl {

/// What the validation layers said, warnings and errors.
class MessageLog {
 public:
  void add(const char* id, const char* text);
  uint64_t count() const { return count_; }
  std::vector<std::string> take();

 private:
  std::mutex mutex_;
  std::vector<std::string> messages_;
  std::atomic<uint64_t> count_{0};
};

class Instance {
 public:
  /// @throws Error(Device) without a loader or a driver, or where the validation layer is asked for and not installed.
  explicit Instance(bool validation);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return instance_; }
  bool validation() const { return validation_; }
  bool debugLabels() const { return debugLabels_; }
  bool surfaces() const { return surfaces_; }  ///< of X windows; where the loader has none, nobody misses them
  MessageLog& log() { return log_; }
  /// @throws Error(Device) where there is none.
  std::vector<VkPhysicalDevice> physicalDevices() const;

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  bool validation_ = false, debugLabels_ = false, surfaces_ = false;
  MessageLog log_;
};

/// What the engine wants to know about a device before it makes one of it.
struct DeviceSurvey {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  DeviceInfo info;
  uint32_t queueFamily = 0, timestampBits = 0;
  uint64_t maxBufferSize = 0;
  /// Ray tracing pipelines with their acceleration structures and device addresses, all of them or none.
  bool rayPipelines = false;
  VkPhysicalDeviceRayTracingPipelinePropertiesKHR rayProperties{};
  uint32_t scratchAlignment = 1;
  bool swapchains = false;
  bool floatAtomics = false, storesInGraphics = false, extendedStorageFormats = false;
};
DeviceSurvey survey(VkPhysicalDevice);
/// What DeviceSurvey::rayPipelines asks for, and a device is then made with.
inline constexpr const char* kRayExtensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
                                                 VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};

}  // namespace hl
