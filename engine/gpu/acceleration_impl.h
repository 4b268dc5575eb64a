#pragma once
// What an AccelerationStructure holds behind its handle.
#include <utility>

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
  Level bottom, top;
};

}  // namespace hl
