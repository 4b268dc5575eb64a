#pragma once
#include "engine/passes/gbuffer.h"

namespace hl {

/// RGBA32F of the G-buffer's size: `image` where it has that, else a new one.
GpuImage pixelImage(Device&, const GpuImage& image, const char* name, const GBuffer&);

}  // namespace hl
