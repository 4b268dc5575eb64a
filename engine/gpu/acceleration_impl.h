#pragma once
// What an AccelerationStructure holds behind its handle.
#include <utility>
#include <vector>

#include "engine/gpu/device_impl.h"

namespace hl {

struct AccelerationState {
  struct Level {
    std::shared_ptr<Device::Impl> device;
    Buffer storage;
    VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
    Level() = default;
    Level(Level&& o) noexcept : device(std::move(o.device)), storage(std::move(o.storage)), handle(std::exchange(o.handle, VK_NULL_HANDLE)) {}
    Level& operator=(Level&& o) noexcept {
      std::swap(device, o.device), std::swap(storage, o.storage), std::swap(handle, o.handle);
      return *this;
    }
    ~Level();
  };
  /// How a level is built again in its place.
  struct Recipe {
    VkAccelerationStructureTypeKHR type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
    VkBuildAccelerationStructureFlagsKHR flags = 0;
    std::vector<VkAccelerationStructureGeometryKHR> geometries;
    std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
    Buffer scratch;
    VkDeviceAddress scratchAddress = 0;
  };
  Level bottom, moving, top;
  Recipe movingRecipe, topRecipe;   ///< where there is geometry that moves
  std::vector<Buffer> inputs;       ///< of the recipes: vertices, indices, instances
  Buffer movingVertices;
  uint32_t updates = 0;
};

/// Fits what moves to where its vertices are now, or builds it anew every kUpdatesABuild times; then the top level. Needs barriers for the vertices alone.
void recordUpdate(VkCommandBuffer, AccelerationState&);

}  // namespace hl
