// The one place where volk's implementation is compiled.
#define VOLK_IMPLEMENTATION
#include "engine/gpu/vulkan.h"

namespace hl {

std::string resultName(VkResult result) {
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      return "the device was lost";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialisation failed";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "a layer is not installed";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "an extension is not supported";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "a feature is not supported";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "no compatible driver";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "too many objects";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
      return "the format is not supported";
    case VK_ERROR_FRAGMENTED_POOL:
      return "a pool is fragmented";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "out of pool memory";
    case VK_ERROR_SURFACE_LOST_KHR:
      return "the window's surface was lost";
    case VK_ERROR_OUT_OF_DATE_KHR:
      return "the window has changed";
    case VK_ERROR_NATIVE_WINDOW_IN_USE_KHR:
      return "the window is in use already";
    default:
      return "Vulkan result " + std::to_string(static_cast<int>(result));
  }
}

}  // namespace hl
