#include "engine/gpu/memory.h"

#include <fmt/core.h>

#include <algorithm>

namespace hl {

DeviceMemory::DeviceMemory(VkPhysicalDevice physical, VkDevice device, bool hostVisible, bool addresses)
    : device_(device), hostVisible_(hostVisible), addresses_(addresses) {
  vkGetPhysicalDeviceMemoryProperties(physical, &properties_);
  VkPhysicalDeviceVulkan11Properties limits{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &limits, {}};
  vkGetPhysicalDeviceProperties2(physical, &all);
  largestAllocation_ = limits.maxMemoryAllocationSize;
  heapUsed_.resize(properties_.memoryHeapCount, 0);
}

DeviceMemory::~DeviceMemory() {
  for (const auto& block : blocks_) vkFreeMemory(device_, block->memory, nullptr);
}

/// Memory types that serve `use`, best first.
std::vector<uint32_t> DeviceMemory::typesFor(uint32_t allowed, MemoryUse use) const {
  const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, cached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  std::vector<std::pair<int, uint32_t>> scored;
  for (uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
    if ((allowed & (1u << i)) == 0) continue;
    const VkMemoryPropertyFlags flags = properties_.memoryTypes[i].propertyFlags;
    if ((flags & (VK_MEMORY_PROPERTY_PROTECTED_BIT | VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT |
                  VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD)) != 0) {
      continue;
    }
    const bool visible = (flags & host) == host;
    int score = 0;
    switch (use) {
      case MemoryUse::Device:
        // Where the host shares the memory, a mapped type spares every staging copy; elsewhere a window on device
        // memory (often small) is left alone.
        score = ((flags & local) != 0 ? 4 : 0) + (visible == hostVisible_ ? 2 : 0);
        if (hostVisible_ && (flags & cached) != 0) score += 1;
        break;
      case MemoryUse::Upload:
        if (!visible) continue;
        score = (flags & local) == 0 ? 2 : 1;
        break;
      case MemoryUse::Readback:
        if (!visible) continue;
        score = ((flags & cached) != 0 ? 2 : 0) + ((flags & local) == 0 ? 1 : 0);
        break;
    }
    scored.emplace_back(-score, i);
  }
  std::sort(scored.begin(), scored.end());
  std::vector<uint32_t> types;
  for (const auto& [score, type] : scored) types.push_back(type);
  return types;
}

/// A block of at least `bytes`, or null where its heap has no room.
MemoryBlock* DeviceMemory::newBlock(uint32_t type, uint64_t bytes, bool tiled, bool dedicated) {
  const uint32_t heap = properties_.memoryTypes[type].heapIndex;
  const uint64_t heapSize = properties_.memoryHeaps[heap].size;
  if (bytes > largestAllocation_ || heapUsed_[heap] + bytes > heapSize) return nullptr;

  auto block = std::make_unique<MemoryBlock>();
  VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  const VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, addresses_ ? &flags : nullptr, bytes, type};
  if (vkAllocateMemory(device_, &info, nullptr, &block->memory) != VK_SUCCESS) return nullptr;
  if ((properties_.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0) {
    void* mapped = nullptr;
    if (vkMapMemory(device_, block->memory, 0, VK_WHOLE_SIZE, 0, &mapped) != VK_SUCCESS) {
      vkFreeMemory(device_, block->memory, nullptr);
      return nullptr;
    }
    block->mapped = static_cast<char*>(mapped);
  }
  block->size = bytes;
  block->type = type;
  block->tiled = tiled;
  block->dedicated = dedicated;
  block->free = FreeList(bytes);
  heapUsed_[heap] += bytes;
  blocks_.push_back(std::move(block));
  return blocks_.back().get();
}

Allocation DeviceMemory::allocate(const VkMemoryRequirements& need, MemoryUse use, bool tiled,
                                  const std::string& what) {
  std::lock_guard lock(mutex_);
  for (const uint32_t type : typesFor(need.memoryTypeBits, use)) {
    const bool dedicated = need.size > kBlockBytes;
    if (!dedicated) {
      for (const auto& block : blocks_) {
        if (block->type != type || block->tiled != tiled || block->dedicated) continue;
        if (const auto offset = block->free.allocate(need.size, need.alignment)) {
          bytes_ += need.size;
          return {block.get(), *offset, need.size};
        }
      }
    }
    MemoryBlock* block = newBlock(type, dedicated ? need.size : kBlockBytes, tiled, dedicated);
    // A heap with less left than a whole block may still hold the resource itself.
    if (block == nullptr && !dedicated) block = newBlock(type, need.size, tiled, true);
    if (block == nullptr) continue;
    const auto offset = block->free.allocate(need.size, 1);
    bytes_ += need.size;
    return {block, *offset, need.size};
  }
  if (need.size > largestAllocation_)
    throw Error(ErrorKind::TooLarge, fmt::format("{}: {} bytes are more than this device gives in one piece ({})", what, need.size, largestAllocation_));
  throw Error(ErrorKind::TooLarge,
              fmt::format("{}: no device memory left for {:.1f} MiB ({:.1f} MiB are in use)", what,
                          static_cast<double>(need.size) / 1048576.0, static_cast<double>(bytes_) / 1048576.0));
}

void DeviceMemory::release(Allocation& a) {
  if (a.block == nullptr) return;
  std::lock_guard lock(mutex_);
  a.block->free.release(a.offset, a.size);
  bytes_ -= a.size;
  // One empty block of a kind is kept, so that a resource made and dropped every frame does not allocate every frame.
  const auto spare = [&](const auto& b) {
    return b.get() != a.block && b->type == a.block->type && b->tiled == a.block->tiled && !b->dedicated &&
           b->free.empty();
  };
  if (a.block->free.empty() && (a.block->dedicated || std::any_of(blocks_.begin(), blocks_.end(), spare))) {
    heapUsed_[properties_.memoryTypes[a.block->type].heapIndex] -= a.block->size;
    vkFreeMemory(device_, a.block->memory, nullptr);
    std::erase_if(blocks_, [&](const auto& b) { return b.get() == a.block; });
  }
  a = {};
}

uint64_t DeviceMemory::bytesAllocated() const {
  std::lock_guard lock(mutex_);
  return bytes_;
}

size_t DeviceMemory::blocks() const {
  std::lock_guard lock(mutex_);
  return blocks_.size();
}

}  // namespace hl
