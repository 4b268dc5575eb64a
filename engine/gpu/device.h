#pragma once
// The Vulkan device: any vendor, lavapipe where there is nothing better. One queue. Vulkan's headers are in
// engine/gpu's own files alone.
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/acceleration.h"
#include "engine/gpu/resources.h"

namespace hl {

struct DeviceOptions {
  std::string
      select;  ///< "": the best (discrete, integrated, virtual, CPU); else an index of listDevices() or part of a name
  bool validation = false;  ///< validation and synchronisation validation; HALFLIGHT_VALIDATION=1 turns it on as well
  bool staging =
      false;  ///< act as on a device whose memory the host cannot map, so that tests reach those paths anywhere
};

struct DeviceInfo {
  std::string name, type, driver, api;                 ///< type: "discrete", "integrated", "virtual", "cpu", "other"
  std::vector<std::pair<std::string, bool>> features;  ///< what the engine looks for, and whether it is there
  std::string missing;                                 ///< what makes the device unusable, or ""
};
/// @throws Error(Device) where there is no Vulkan loader or driver, saying how to get one.
std::vector<DeviceInfo> listDevices();

class Device {
 public:
  /// @throws Error(Device) naming what is missing; Error(BadInput) for a selection that matches nothing (with the
  /// list).
  explicit Device(const DeviceOptions& = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const;
  bool isCpu() const;
  bool timestampsSupported() const;
  bool rayPipelines() const;  ///< acceleration structures and FrameGraph::rays work
  uint64_t maxStorageBufferBytes() const;
  uint32_t maxTexelBufferElements() const;

  /// Contents are undefined. @throws Error(TooLarge) when memory is exhausted, naming the buffer and its size.
  Buffer buffer(const std::string& name, uint64_t bytes, TexelFormat = TexelFormat::None);
  GpuImage image(const std::string& name, const ImageDesc&);
  /// Built at once, for fast tracing. @throws Error(Device) where the device has no ray tracing pipelines
  /// `moving`: geometry whose vertices FrameGraph::update() follows; gl_InstanceCustomIndexEXT is 1 there, and gl_GeometryIndexEXT counts in its own list.
  AccelerationStructure accelerationStructure(const std::string& name, std::span<const TriangleGeometry>, std::span<const TriangleGeometry> moving = {});

  /// Blocking copies, outside any frame graph.
  void upload(const Buffer&, const void* data, uint64_t bytes, uint64_t offset = 0);
  void download(const Buffer&, void* data, uint64_t bytes, uint64_t offset = 0);
  template <class T>
  Buffer buffer(const std::string& name, std::span<const T> data) {
    Buffer b = buffer(name, data.empty() ? sizeof(T) : data.size_bytes());
    if (!data.empty()) upload(b, data.data(), data.size_bytes());
    return b;
  }
  /// RGBA8 or float data for one layer's mip 0; further mips are filtered from it when `generateMips`.
  void upload(const GpuImage&, int layer, const void* data, uint64_t bytes);
  void generateMips(const GpuImage&);
  /// Float formats only (16-bit ones are widened); channels as the format has.
  Image download(const GpuImage&);
  void download(const GpuImage&, void* data, uint64_t bytes);  ///< raw texels of layer 0, mip 0
  void waitIdle();

  /// Messages of the validation layers since the start (counted even where nobody looks); tests assert on it.
  uint64_t validationMessages() const;
  std::vector<std::string> takeValidationMessages();

  uint64_t bytesAllocated() const;
  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;  // resources keep it alive
};

}  // namespace hl
