#pragma once
// Vulkan for the files of engine/gpu: functions come from volk, results become errors.
#include <volk.h>

#include <string>

#include "engine/core/error.h"

namespace hl {

std::string resultName(VkResult);

/// @throws Error(Device) "<what>: <reason>" unless the call succeeded.
inline void check(VkResult result, const std::string& what) {
  if (result < VK_SUCCESS) throw Error(ErrorKind::Device, what + ": " + resultName(result));
}

}  // namespace hl
