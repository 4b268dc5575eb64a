#pragma once
// Images of a window, drawn into like any other image and then shown. Nothing is in flight: the engine waits for what it submits, and so does this.
#include <cstdint>
#include <memory>
#include <string>

#include "engine/gpu/device.h"

namespace hl {

class Swapchain {
 public:
  /// Why this device and loader have no swapchains on X windows; "" where they have.
  static const std::string& unavailable(const Device&);
  /// The VkInstance, for a window toolkit to make a surface of. It lives as long as any copy of this.
  static std::shared_ptr<void> instanceOf(const Device&);

  /// `surface`: a VkSurfaceKHR of that instance; it must outlive the swapchain.
  /// @throws Error(Device) saying why the device's queue cannot show anything there.
  Swapchain(Device&, uint64_t surface);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  /// The image to draw into, as large as the window is at this moment; an empty handle where the window has no area, or gives no image within
  /// `timeoutMs`. Contents are undefined. @throws Error(Device) when device or surface are lost.
  GpuImage acquire(int timeoutMs);
  /// Shows what was drawn into the image acquired last. False where the window changed meanwhile and it was not shown: acquire and draw again.
  bool present();

  uint64_t built() const;  ///< how often images were made for a new size of the window

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
