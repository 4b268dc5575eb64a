#pragma once
// Shows the session's pictures in a window, from the device, on a thread of its own: a window is redrawn at once when it changes, whatever the session is
// at, and whoever changes it waits for nothing. The toolkit that owns the window makes its surface; this file knows neither toolkit nor Vulkan.
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/device.h"

namespace hl {

class ShaderLibrary;

/// What lies over the picture, as large as the window: RGBA8 with premultiplied alpha, rows from the top.
struct Overlay {
  int width = 0, height = 0;
  std::vector<unsigned char> rgba;
};

/// How the window shows the picture, in its own pixels.
struct PresentView {
  float x = 0, y = 0, width = 0, height = 0;  ///< where the whole picture lies; it may reach beyond the window
  bool smooth = false;                        ///< between pixels: bilinear; else the nearest one
  bool picture = true;                        ///< false: nothing but the overlay
  float background[3] = {0, 0, 0};            ///< display values
  std::shared_ptr<const Overlay> overlay;     ///< or null
  bool operator==(const PresentView&) const = default;
};

struct PresentReport {
  uint64_t presented = 0;   ///< times the window was drawn
  uint64_t pictures = 0;    ///< ... of which with a picture of the session's for the first time
  uint64_t swapchains = 0;  ///< made, for new sizes or new windows
  int width = 0, height = 0;  ///< of the window, when it was drawn last
};

class Presenter {
 public:
  /// Makes nothing before something is wanted. The device must outlive end().
  explicit Presenter(Device&);
  ~Presenter();
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  // For the window's owner, from one thread; all but detach() return at once.

  /// The VkInstance that the surface must be of; it lives as long as this.
  void* vulkanInstance() const;
  const std::string& noPresentation() const;  ///< why it cannot show anything (Swapchain::unavailable), or ""
  const std::string& deviceName() const;
  bool ofCpu() const;  ///< the device is the CPU
  /// From now on pictures are taken from the session, and drawn into `surface` (a VkSurfaceKHR). `answer` is called on the presenter's thread, with ""
  /// when the window is first drawn, and with the reason when it cannot be shown to or no longer can: nothing is shown after that.
  void attach(uint64_t surface, std::function<void(const std::string& why)> answer);
  /// Waits until nothing uses the surface, and nobody is in `answer`: at most what is being drawn at the moment, or the unit of work that the device is at. Then it may go.
  void detach();
  void setView(const PresentView&);
  /// A hidden window is not drawn; pictures are still taken, so that it has the newest when it comes back.
  void setVisible(bool);
  PresentReport report() const;

  // For the session, from its thread.

  /// Whether pictures are shown from the device, so that nobody needs them on the host.
  bool attached() const;
  /// Takes a copy of the picture and draws it; returns when it is shown, so that nothing is drawn while the next frame is timed. Errors go to the
  /// window's owner.
  void publish(const GpuImage& picture);
  /// The device goes: the thread ends, and all calls after this do nothing.
  void end();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
