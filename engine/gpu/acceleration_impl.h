#pragma once
// What an AccelerationStructure holds behind its handle.
#include "engine/gpu/device_impl.h"

namespace hl {

struct AccelerationState {
  struct Level {
    Buffer storage;
    VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
  };
  std::shared_ptr<Device::Impl> device;
  Level bottom, top;
  ~AccelerationState();
};

}  // namespace hl
