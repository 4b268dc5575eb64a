#pragma once
// What Device, Buffer and GpuImage hold behind their handles.
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "engine/gpu/device.h"
#include "engine/gpu/hazards.h"
#include "engine/gpu/instance.h"
#include "engine/gpu/memory.h"

namespace hl {

struct Device::Impl : std::enable_shared_from_this<Device::Impl> {
  explicit Impl(const DeviceOptions&);
  ~Impl();

  std::shared_ptr<Instance> instance;  ///< shared with whoever made a surface from it
  DeviceSurvey survey;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::unique_ptr<DeviceMemory> memory;
  VkSampler clampSampler = VK_NULL_HANDLE, repeatSampler = VK_NULL_HANDLE, nearestSampler = VK_NULL_HANDLE;
  bool cpu = false;
  bool hostVisible = false;  ///< the host reads and writes buffers in place
  std::string noPresentation;  ///< why there are no swapchains, or ""
  PFN_vkCmdBeginDebugUtilsLabelEXT beginLabel = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT endLabel = nullptr;
  PFN_vkSetDebugUtilsObjectNameEXT setName = nullptr;

  Buffer makeBuffer(const std::string& name, uint64_t bytes, TexelFormat, MemoryUse);
  GpuImage makeImage(const std::string& name, const ImageDesc&);
  VkDeviceAddress address(const Buffer&) const;  ///< where survey.rayPipelines
  void name(VkObjectType, uint64_t handle, const std::string&) const;
  /// Submits and waits. @throws Error(Device) when the device is lost.
  void submit(VkCommandBuffer);
  /// A call that needs the queue to itself, and is no submission.
  VkResult onQueue(const std::function<VkResult(VkQueue)>&);
  /// Records commands, submits them and waits.
  void once(const std::function<void(VkCommandBuffer)>&);

 private:
  std::mutex queueMutex_, onceMutex_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
};

struct BufferState {
  std::shared_ptr<Device::Impl> device;
  std::string name;
  uint64_t size = 0;
  VkBuffer handle = VK_NULL_HANDLE;
  VkBufferView texels = VK_NULL_HANDLE;
  Allocation allocation;
  void* mapped = nullptr;
  ResourceHistory history;
  ~BufferState();
};

struct ImageState {
  std::shared_ptr<Device::Impl> device;
  std::string name;
  ImageDesc desc;
  VkImage handle = VK_NULL_HANDLE;
  VkImageView sampled = VK_NULL_HANDLE;       ///< 2D, all mips; null where there are layers
  VkImageView sampledArray = VK_NULL_HANDLE;  ///< 2D array, all mips; null for depth
  VkImageView storage = VK_NULL_HANDLE;       ///< mip 0: storage and attachment
  VkImageUsageFlags usage = 0;
  bool ofSwapchain = false;  ///< image and memory are the swapchain's; the views are ours
  VkFormat windowFormat = VK_FORMAT_UNDEFINED;  ///< of those: channels in an order that `desc` has no word for
  bool filterable = false;  ///< linear filtering
  Allocation allocation;
  ResourceHistory history;
  ~ImageState();
  VkImageSubresourceRange range() const;
};

struct FormatInfo {
  const char* name;
  VkFormat vk;
  int bytes, channels;
  bool floating, integer;  ///< neither: normalised
};
const FormatInfo& formatInfo(Format);

VkBufferMemoryBarrier2 bufferBarrier(const BufferState&, const Dependency&);
VkImageMemoryBarrier2 imageBarrier(const ImageState&, const Dependency&);
/// One barrier for `use`, where it is needed. For copies outside a graph.
void transition(VkCommandBuffer, BufferState&, const ResourceUse&);
void transition(VkCommandBuffer, ImageState&, const ResourceUse&);

inline constexpr ResourceUse kTransferRead{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, 0,
                                           VK_IMAGE_LAYOUT_UNDEFINED};
inline constexpr ResourceUse kTransferWrite{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, 0, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                            VK_IMAGE_LAYOUT_UNDEFINED};
inline constexpr ResourceUse kImageTransferRead{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, 0,
                                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
inline constexpr ResourceUse kImageTransferWrite{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, 0,
                                                 VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL};

}  // namespace hl
