#include "engine/gpu/instance.h"

#include <fmt/core.h>

#ifdef __SANITIZE_ADDRESS__
#include <dlfcn.h>
#include <link.h>
#endif

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/core/log.h"

namespace hl {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
// Surfaces of the one window system that docks can float on; named here, since its header would need XCB's.
constexpr const char* kSurfaceExtensions[] = {VK_KHR_SURFACE_EXTENSION_NAME, "VK_KHR_xcb_surface"};
constexpr const char* kNoVulkan =
    "no Vulkan {}: install libvulkan1 and a driver for the GPU, or mesa-vulkan-drivers for the CPU (lavapipe)";

/// Messages that are passed over, each with the reason. Reviewed with every new driver or layer; empty is the aim.
struct Ignored {
  const char* id;
  const char* reason;
};
constexpr Ignored kIgnored[] = {
    {"Loader Message", "the loader's remarks on other drivers' manifests, not on what this program does"},
};

#ifdef __SANITIZE_ADDRESS__
/// Keeps drivers and layers mapped to the end: a leak report can name, and a suppression match, only what is still loaded.
int keepLoaded(dl_phdr_info* info, size_t, void*) {
  if (info->dlpi_name && info->dlpi_name[0] == '/') dlopen(info->dlpi_name, RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
  return 0;
}
#endif

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  static_cast<MessageLog*>(user)->add(data->pMessageIdName, data->pMessage);
  return VK_FALSE;
}

bool hasExtension(const char* layer, const char* name) {
  uint32_t count = 0;
  vkEnumerateInstanceExtensionProperties(layer, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateInstanceExtensionProperties(layer, &count, all.data());
  return std::any_of(all.begin(), all.end(), [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

bool hasLayer(const char* name) {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> all(count);
  vkEnumerateInstanceLayerProperties(&count, all.data());
  return std::any_of(all.begin(), all.end(), [&](const auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

const char* typeName(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "cpu";
    default:
      return "other";
  }
}

}  // namespace

void MessageLog::add(const char* id, const char* text) {
  for (const Ignored& ignored : kIgnored) {
    if (id != nullptr && std::strcmp(id, ignored.id) == 0) {
      hl::log(LogLevel::Debug, fmt::format("Vulkan: {}", text));
      return;
    }
  }
  logError(fmt::format("Vulkan: {}", text));
  ++count_;
  std::lock_guard lock(mutex_);
  messages_.emplace_back(text);
}

std::vector<std::string> MessageLog::take() {
  std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

Instance::Instance(bool validation) : validation_(validation) {
  static const VkResult loader = volkInitialize();
  if (loader != VK_SUCCESS) throw Error(ErrorKind::Device, fmt::format(kNoVulkan, "loader (libvulkan.so.1)"));
  if (volkGetInstanceVersion() < VK_API_VERSION_1_3) {
    throw Error(ErrorKind::Device, "the Vulkan loader is older than 1.3: update libvulkan1");
  }

  std::vector<const char*> layers, extensions;
  debugLabels_ = hasExtension(nullptr, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  const VkValidationFeatureEnableEXT enabled[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enabled;
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                          VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = onMessage;
  messenger.pUserData = &log_;
  if (validation_) {
    if (!hasLayer(kValidationLayer)) {
      throw Error(ErrorKind::Device,
                  "validation is asked for, but VK_LAYER_KHRONOS_validation is not installed: install "
                  "vulkan-validationlayers");
    }
    layers.push_back(kValidationLayer);
    debugLabels_ = debugLabels_ || hasExtension(kValidationLayer, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (!debugLabels_ || !hasExtension(kValidationLayer, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME)) {
      throw Error(ErrorKind::Device,
                  "the installed validation layer has no synchronisation validation: update "
                  "vulkan-validationlayers");
    }
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    features.pNext = &messenger;
  }
  if (debugLabels_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  surfaces_ = std::all_of(std::begin(kSurfaceExtensions), std::end(kSurfaceExtensions),
                                      [](const char* name) { return hasExtension(nullptr, name); });
  if (surfaces_) extensions.insert(extensions.end(), std::begin(kSurfaceExtensions), std::end(kSurfaceExtensions));

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "Halflight";
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pNext = validation_ ? &features : nullptr;
  info.pApplicationInfo = &application;
  info.enabledLayerCount = static_cast<uint32_t>(layers.size());
  info.ppEnabledLayerNames = layers.data();
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw Error(ErrorKind::Device, fmt::format(kNoVulkan, "driver"));
  check(result, "creating the Vulkan instance");
  // The loader's own entry points, which serve every instance and device: several may live at once.
  volkLoadInstance(instance_);
  if (validation_) {
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    check(create(instance_, &messenger, nullptr, &messenger_), "creating the validation messenger");
  }
}

Instance::~Instance() {
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
#ifdef __SANITIZE_ADDRESS__
  dl_iterate_phdr(keepLoaded, nullptr);
#endif
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physicalDevices() const {
  uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance_, &count, nullptr), "listing Vulkan devices");
  std::vector<VkPhysicalDevice> all(count);
  check(vkEnumeratePhysicalDevices(instance_, &count, all.data()), "listing Vulkan devices");
  if (all.empty()) throw Error(ErrorKind::Device, fmt::format(kNoVulkan, "device"));
  return all;
}

DeviceSurvey survey(VkPhysicalDevice physical) {
  DeviceSurvey s;
  s.handle = physical;
  VkPhysicalDeviceMaintenance4Properties maintenance{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  vkGetPhysicalDeviceProperties(physical, &s.properties);
  const uint32_t api = s.properties.apiVersion;
  s.info.name = s.properties.deviceName;
  s.info.type = typeName(s.properties.deviceType);
  s.info.api = fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(api), VK_API_VERSION_MINOR(api), VK_API_VERSION_PATCH(api));
  if (api < VK_API_VERSION_1_3) {
    s.info.missing = "Vulkan 1.3";
    return s;
  }
  properties.pNext = &driver;
  driver.pNext = &maintenance;
  vkGetPhysicalDeviceProperties2(physical, &properties);
  s.info.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
  s.maxBufferSize = maintenance.maxBufferSize;

  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
  const auto has = [&](const char* name) {
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
  };

  VkPhysicalDeviceShaderAtomicFloatFeaturesEXT atomics{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_FLOAT_FEATURES_EXT};
  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  features.pNext = &v12;
  v12.pNext = &v13;
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rays{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  const bool rayExtensions =
      std::all_of(std::begin(kRayExtensions), std::end(kRayExtensions), [&](const char* name) { return has(name); });
  if (has(VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME)) v13.pNext = &atomics;
  if (rayExtensions) rays.pNext = &structures, structures.pNext = v13.pNext, v13.pNext = &rays;
  vkGetPhysicalDeviceFeatures2(physical, &features);
  s.rayPipelines = rays.rayTracingPipeline == VK_TRUE && structures.accelerationStructure == VK_TRUE && v12.bufferDeviceAddress == VK_TRUE;
  if (s.rayPipelines) {
    VkPhysicalDeviceAccelerationStructurePropertiesKHR structure{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
    s.rayProperties = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR};
    s.rayProperties.pNext = &structure;
    VkPhysicalDeviceProperties2 more{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    more.pNext = &s.rayProperties;
    vkGetPhysicalDeviceProperties2(physical, &more);
    s.rayProperties.pNext = nullptr;
    s.scratchAlignment = structure.minAccelerationStructureScratchOffsetAlignment;
  }
  s.swapchains = has(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  s.floatAtomics = atomics.shaderBufferFloat32AtomicAdd == VK_TRUE;
  s.storesInGraphics = features.features.vertexPipelineStoresAndAtomics == VK_TRUE &&
                       features.features.fragmentStoresAndAtomics == VK_TRUE;
  s.extendedStorageFormats = features.features.shaderStorageImageExtendedFormats == VK_TRUE;

  uint32_t families = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, nullptr);
  std::vector<VkQueueFamilyProperties> queues(families);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &families, queues.data());
  const VkQueueFlags wanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  const auto queue = std::find_if(queues.begin(), queues.end(),
                                  [&](const auto& q) { return (q.queueFlags & wanted) == wanted && q.queueCount > 0; });
  if (queue != queues.end()) {
    s.queueFamily = static_cast<uint32_t>(queue - queues.begin());
    s.timestampBits = queue->timestampValidBits;
  }

  const std::pair<const char*, bool> needed[] = {
      {"graphics and compute queue", queue != queues.end()},
      {"dynamic rendering", v13.dynamicRendering == VK_TRUE},
      {"synchronization2", v13.synchronization2 == VK_TRUE},
      {"maintenance4", v13.maintenance4 == VK_TRUE},
      {"scalar block layout", v12.scalarBlockLayout == VK_TRUE},
      {"storage buffers in vertex and fragment shaders", s.storesInGraphics},
      {"storage images of all formats", s.extendedStorageFormats},
  };
  for (const auto& [name, there] : needed) {
    s.info.features.emplace_back(name, there);
    if (!there) s.info.missing += (s.info.missing.empty() ? "" : ", ") + std::string(name);
  }
  s.info.features.emplace_back("timestamps", s.timestampBits > 0);
  s.info.features.emplace_back("float atomics", s.floatAtomics);
  s.info.features.emplace_back("ray tracing pipelines", s.rayPipelines);
  s.info.features.emplace_back("ray queries", has(VK_KHR_RAY_QUERY_EXTENSION_NAME));
  return s;
}

}  // namespace hl
