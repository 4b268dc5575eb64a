#pragma once
// Device memory in blocks, handed out in pieces. Linear (buffers) and tiled (images) resources never share a block, so
// that bufferImageGranularity never matters.
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/gpu/free_list.h"
#include "engine/gpu/vulkan.h"

namespace hl {

enum class MemoryUse {
  Device,    ///< device-local; host-visible as well on CPU and integrated devices
  Upload,    ///< host-visible, written by the host: uniforms, staging
  Readback,  ///< host-visible, cached where there is such a type
};

struct MemoryBlock {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  uint64_t size = 0;
  uint32_t type = 0;
  bool tiled = false, dedicated = false;
  char* mapped = nullptr;  ///< the whole block, where its type is host-visible
  FreeList free{1};
};

struct Allocation {
  MemoryBlock* block = nullptr;
  uint64_t offset = 0, size = 0;
  VkDeviceMemory memory() const { return block->memory; }
  void* mapped() const { return block->mapped == nullptr ? nullptr : block->mapped + offset; }
};

class DeviceMemory {
 public:
  static constexpr uint64_t kBlockBytes = 64ull << 20;  ///< larger resources get a block of their own

  /// `hostVisible`: device resources go to mapped memory; false asks for staging wherever the device allows.
  /// `addresses`: buffers may be asked for their device address.
  DeviceMemory(VkPhysicalDevice, VkDevice, bool hostVisible, bool addresses);
  ~DeviceMemory();
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  /// @throws Error(TooLarge) naming `what` and its size when no memory is left.
  Allocation allocate(const VkMemoryRequirements&, MemoryUse, bool tiled, const std::string& what);
  void release(Allocation&);
  uint64_t bytesAllocated() const;  ///< by resources, without what is free in the blocks
  size_t blocks() const;

 private:
  std::vector<uint32_t> typesFor(uint32_t allowed, MemoryUse) const;
  MemoryBlock* newBlock(uint32_t type, uint64_t bytes, bool tiled, bool dedicated);

  VkDevice device_;
  bool hostVisible_, addresses_;
  VkPhysicalDeviceMemoryProperties properties_{};
  uint64_t largestAllocation_ = 0;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<MemoryBlock>> blocks_;
  std::vector<uint64_t> heapUsed_;
  uint64_t bytes_ = 0;
};

}  // namespace hl
