#include "engine/gpu/swapchain.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "engine/gpu/device_impl.h"

namespace hl {
namespace {

constexpr int kAttempts = 4;  // a window that is being dragged larger changes between any two calls
constexpr uint64_t kNsPerMs = 1'000'000;

/// Of this instance and device: the global ones are those of the instance made last, which may have been made without these extensions.
struct Calls {
  PFN_vkGetPhysicalDeviceSurfaceSupportKHR support;
  PFN_vkGetPhysicalDeviceSurfaceCapabilitiesKHR capabilities;
  PFN_vkGetPhysicalDeviceSurfaceFormatsKHR formats;
  PFN_vkGetPhysicalDeviceSurfacePresentModesKHR presentModes;
  PFN_vkCreateSwapchainKHR create;
  PFN_vkDestroySwapchainKHR destroy;
  PFN_vkGetSwapchainImagesKHR images;
  PFN_vkAcquireNextImageKHR acquire;
  PFN_vkQueuePresentKHR present;

  Calls(VkInstance instance, VkDevice device) {
    const auto ofInstance = [&](auto& f, const char* name) { f = reinterpret_cast<std::decay_t<decltype(f)>>(vkGetInstanceProcAddr(instance, name)); };
    const auto ofDevice = [&](auto& f, const char* name) { f = reinterpret_cast<std::decay_t<decltype(f)>>(vkGetDeviceProcAddr(device, name)); };
    ofInstance(support, "vkGetPhysicalDeviceSurfaceSupportKHR");
    ofInstance(capabilities, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    ofInstance(formats, "vkGetPhysicalDeviceSurfaceFormatsKHR");
    ofInstance(presentModes, "vkGetPhysicalDeviceSurfacePresentModesKHR");
    ofDevice(create, "vkCreateSwapchainKHR");
    ofDevice(destroy, "vkDestroySwapchainKHR");
    ofDevice(images, "vkGetSwapchainImagesKHR");
    ofDevice(acquire, "vkAcquireNextImageKHR");
    ofDevice(present, "vkQueuePresentKHR");
  }
};

const Device::Impl& presentable(const Device& device) {
  if (const std::string& why = Swapchain::unavailable(device); !why.empty()) throw Error(ErrorKind::Device, why);
  return device.impl();
}

template <class T, class Call>
std::vector<T> listed(const Call& call, const char* what) {
  uint32_t count = 0;
  check(call(&count, nullptr), what);
  std::vector<T> all(count);
  check(call(&count, all.data()), what);
  all.resize(count);
  return all;
}

}  // namespace

struct Swapchain::Impl {
  std::shared_ptr<Device::Impl> device;
  Calls calls;
  VkSurfaceKHR surface;
  VkSurfaceFormatKHR surfaceFormat{};
  VkPresentModeKHR mode = VK_PRESENT_MODE_FIFO_KHR;  // the one that every device has
  VkSwapchainKHR handle = VK_NULL_HANDLE;
  VkExtent2D extent{};
  std::vector<GpuImage> images;
  std::optional<uint32_t> acquired;
  VkFence fence = VK_NULL_HANDLE;
  uint64_t built = 0;
  bool stale = true;

  Impl(Device& d, uint64_t surfaceHandle)
      : device(d.impl().shared_from_this()), calls(presentable(d).instance->handle(), device->device), surface(reinterpret_cast<VkSurfaceKHR>(surfaceHandle)) {
    VkPhysicalDevice physical = device->survey.handle;
    VkBool32 supported = VK_FALSE;
    check(calls.support(physical, device->survey.queueFamily, surface, &supported), "asking whether the window can be drawn to");
    if (supported != VK_TRUE) throw Error(ErrorKind::Device, fmt::format("the queue of {} cannot show pictures in this window", device->survey.info.name));
    chooseFormat();
    // A frame is shown when it is done; waiting for the screen would set the pace of frames that are timed.
    const auto modes = listed<VkPresentModeKHR>([&](uint32_t* n, VkPresentModeKHR* all) { return calls.presentModes(physical, surface, n, all); }, "the window's present modes");
    for (const VkPresentModeKHR wanted : {VK_PRESENT_MODE_IMMEDIATE_KHR, VK_PRESENT_MODE_MAILBOX_KHR})
      if (std::find(modes.begin(), modes.end(), wanted) != modes.end()) mode = wanted;
    const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    check(vkCreateFence(device->device, &info, nullptr, &fence), "creating a fence");
  }

  ~Impl() {
    release();
    calls.destroy(device->device, handle, nullptr);
    vkDestroyFence(device->device, fence, nullptr);
  }

  /// The bytes of a picture as they are: no conversion to sRGB, for they are that already.
  void chooseFormat() {
    const auto offered = listed<VkSurfaceFormatKHR>([&](uint32_t* n, VkSurfaceFormatKHR* all) { return calls.formats(device->survey.handle, surface, n, all); }, "the window's formats");
    for (const VkSurfaceFormatKHR& f : offered)
      if ((f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM) && f.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) {
        surfaceFormat = f;
        return;
      }
    throw Error(ErrorKind::Device, fmt::format("{} draws to this window neither in BGRA8 nor in RGBA8", device->survey.info.name));
  }

  /// The presentation engine may still read what was presented last; our own work has been waited for.
  void release() {
    images.clear();
    acquired.reset();
    if (handle != VK_NULL_HANDLE) device->onQueue([](VkQueue queue) { return vkQueueWaitIdle(queue); });
  }

  /// False where the window has no area.
  bool fit() {
    VkSurfaceCapabilitiesKHR c{};
    check(calls.capabilities(device->survey.handle, surface, &c), "the window");
    if (c.currentExtent.width == 0 || c.currentExtent.height == 0) return false;
    if (!stale && c.currentExtent.width == extent.width && c.currentExtent.height == extent.height) return true;
    release();
    stale = true;
    const VkSwapchainKHR old = handle;
    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface;
    info.minImageCount = c.maxImageCount > 0 ? std::min(c.minImageCount + 1, c.maxImageCount) : c.minImageCount + 1;
    info.imageFormat = surfaceFormat.format;
    info.imageColorSpace = surfaceFormat.colorSpace;
    info.imageExtent = c.currentExtent;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    info.preTransform = c.currentTransform;
    info.compositeAlpha = (c.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR) != 0 ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
    info.presentMode = mode;
    info.clipped = VK_TRUE;
    info.oldSwapchain = old;
    handle = VK_NULL_HANDLE;
    const VkResult result = calls.create(device->device, &info, nullptr, &handle);
    calls.destroy(device->device, old, nullptr);  // retired, whether a new one came of it or not
    check(result, fmt::format("a swapchain of {} x {} pixels", c.currentExtent.width, c.currentExtent.height));
    extent = c.currentExtent;
    stale = false;
    ++built;
    const auto handles = listed<VkImage>([&](uint32_t* n, VkImage* all) { return calls.images(device->device, handle, n, all); }, "the swapchain's images");
    for (VkImage image : handles) images.push_back(wrapped(image));
    return true;
  }

  GpuImage wrapped(VkImage image) {
    auto state = std::make_shared<ImageState>();
    state->device = device;
    state->name = "window";
    state->desc = {static_cast<int>(extent.width), static_cast<int>(extent.height), Format::RGBA8};
    state->windowFormat = surfaceFormat.format;
    state->handle = image;
    state->ofSwapchain = true;
    state->usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    info.image = image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = surfaceFormat.format;
    info.subresourceRange = state->range();
    check(vkCreateImageView(device->device, &info, nullptr, &state->storage), "a view of the window's image");
    return GpuImage(std::move(state));
  }

  GpuImage acquire(int timeoutMs) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      if (!fit()) return {};
      uint32_t index = 0;
      const VkResult result = calls.acquire(device->device, handle, static_cast<uint64_t>(timeoutMs) * kNsPerMs, VK_NULL_HANDLE, fence, &index);
      if (result == VK_ERROR_OUT_OF_DATE_KHR) {
        stale = true;
        continue;
      }
      if (result == VK_TIMEOUT || result == VK_NOT_READY) return {};
      check(result, "the window's next image");
      check(vkWaitForFences(device->device, 1, &fence, VK_TRUE, UINT64_MAX), device->survey.info.name);
      check(vkResetFences(device->device, 1, &fence), device->survey.info.name);
      acquired = index;
      GpuImage& image = images.at(index);
      image.state()->history = {};  // whatever it showed before
      return image;
    }
    return {};
  }

  bool present() {
    const uint32_t index = std::exchange(acquired, std::nullopt).value();
    // The fence that this waits for stands for the semaphore that others hand to the presentation engine.
    device->once([&](VkCommandBuffer commands) { transition(commands, *images[index].state(), {VK_PIPELINE_STAGE_2_NONE, 0, 0, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR}); });
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.swapchainCount = 1;
    info.pSwapchains = &handle;
    info.pImageIndices = &index;
    const VkResult result = device->onQueue([&](VkQueue queue) { return calls.present(queue, &info); });
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
      stale = true;
      return false;
    }
    check(result, "showing a picture");  // suboptimal is shown as well; fit() sees a new size by itself
    return true;
  }
};

Swapchain::Swapchain(Device& device, uint64_t surface) : impl_(std::make_unique<Impl>(device, surface)) {}
Swapchain::~Swapchain() = default;
const std::string& Swapchain::unavailable(const Device& device) { return device.impl().noPresentation; }
std::shared_ptr<void> Swapchain::instanceOf(const Device& device) { return {device.impl().instance, device.impl().instance->handle()}; }
GpuImage Swapchain::acquire(int timeoutMs) { return impl_->acquire(timeoutMs); }
bool Swapchain::present() { return impl_->present(); }
uint64_t Swapchain::built() const { return impl_->built; }

}  // namespace hl
