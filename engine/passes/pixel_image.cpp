#include "engine/passes/pixel_image.h"

namespace hl {

GpuImage pixelImage(Device& device, const GpuImage& image, const char* name, const GBuffer& g) {
  if (image && image.width() == g.width && image.height() == g.height) return image;
  return device.image(name, {g.width, g.height, Format::RGBA32F});
}

}  // namespace hl
