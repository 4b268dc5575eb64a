#pragma once
// Which barrier a resource needs before its next use, from what was done with it before.
#include "engine/gpu/vulkan.h"

namespace hl {

/// How a pass uses a resource as a whole. `layout` is UNDEFINED for buffers.
struct ResourceUse {
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 reads = 0, writes = 0;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
};

/// What is remembered about a resource between uses, over submissions and graphs.
struct ResourceHistory {
  VkPipelineStageFlags2 writeStages = 0;  ///< of the last write or layout change
  VkAccessFlags2 writeAccess = 0;
  VkPipelineStageFlags2 readStages = 0;     ///< of the reads since then
  VkPipelineStageFlags2 visibleStages = 0;  ///< where that write has been made visible
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
};

struct Dependency {
  const char* hazard = nullptr;  ///< "RAW", "WAR", "WAW", "layout", or null where no barrier is needed
  VkPipelineStageFlags2 sourceStages = 0, destinationStages = 0;
  VkAccessFlags2 sourceAccess = 0, destinationAccess = 0;
  VkImageLayout oldLayout = VK_IMAGE_LAYOUT_UNDEFINED, newLayout = VK_IMAGE_LAYOUT_UNDEFINED;
};

/// The dependency of `use` on what `history` holds; `history` then holds `use` as well.
Dependency nextUse(ResourceHistory& history, const ResourceUse& use);

}  // namespace hl
