// Blocking copies between host and device, outside any frame graph.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <vector>

#include "engine/gpu/device_impl.h"

namespace hl {
namespace {

constexpr uint64_t kStagingBytes = 16ull << 20;
constexpr ResourceUse kHostRead{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, 0, VK_IMAGE_LAYOUT_UNDEFINED};
constexpr ResourceUse kHostWrite{VK_PIPELINE_STAGE_2_HOST_BIT, 0, VK_ACCESS_2_HOST_WRITE_BIT,
                                 VK_IMAGE_LAYOUT_UNDEFINED};

void checkRange(const Buffer& b, uint64_t bytes, uint64_t offset, const char* verb) {
  if (offset + bytes > b.size()) {
    throw badInput(
        fmt::format("{} of {} bytes at {} in buffer \"{}\" of {} bytes", verb, bytes, offset, b.name(), b.size()));
  }
}

/// Whether the device has yet to finish with the buffer in a way that the host must wait on. A graph waits for what it
/// submits, so only the caches matter: reads by the host after device writes.
bool deviceWrote(const ResourceHistory& h) {
  return h.writeStages != 0 && (h.visibleStages & VK_PIPELINE_STAGE_2_HOST_BIT) == 0 &&
         h.writeStages != VK_PIPELINE_STAGE_2_HOST_BIT;
}

VkBufferImageCopy layerCopy(const ImageState& image, int layer) {
  VkBufferImageCopy region{};
  region.imageSubresource = {image.range().aspectMask, 0, static_cast<uint32_t>(layer), 1};
  region.imageExtent = {static_cast<uint32_t>(image.desc.width), static_cast<uint32_t>(image.desc.height), 1};
  return region;
}

/// Layer 0, mip 0, as the device holds it.
std::vector<char> rawTexels(Device::Impl& impl, ImageState& image) {
  const uint64_t bytes = static_cast<uint64_t>(image.desc.width) * static_cast<uint64_t>(image.desc.height) *
                         static_cast<uint64_t>(formatInfo(image.desc.format).bytes);
  const Buffer staging = impl.makeBuffer("staging of " + image.name, bytes, TexelFormat::None, MemoryUse::Readback);
  impl.once([&](VkCommandBuffer commands) {
    transition(commands, image, kImageTransferRead);
    const VkBufferImageCopy region = layerCopy(image, 0);
    vkCmdCopyImageToBuffer(commands, image.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.state()->handle, 1,
                           &region);
    staging.state()->history = {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, 0, 0,
                                VK_IMAGE_LAYOUT_UNDEFINED};
    transition(commands, *staging.state(), kHostRead);
  });
  const char* mapped = static_cast<const char*>(staging.state()->mapped);
  return {mapped, mapped + bytes};
}

}  // namespace

void Device::upload(const Buffer& buffer, const void* data, uint64_t bytes, uint64_t offset) {
  checkRange(buffer, bytes, offset, "upload");
  if (bytes == 0) return;
  BufferState& state = *buffer.state();
  if (state.mapped != nullptr) {
    std::memcpy(static_cast<char*>(state.mapped) + offset, data, bytes);
    nextUse(state.history, kHostWrite);  // the device is idle between graphs: nothing to wait for
    return;
  }
  const uint64_t piece = std::min(bytes, kStagingBytes);
  const Buffer staging = impl_->makeBuffer("upload staging", piece, TexelFormat::None, MemoryUse::Upload);
  for (uint64_t done = 0; done < bytes; done += piece) {
    const uint64_t now = std::min(piece, bytes - done);
    std::memcpy(staging.state()->mapped, static_cast<const char*>(data) + done, now);
    impl_->once([&](VkCommandBuffer commands) {
      transition(commands, state, kTransferWrite);
      const VkBufferCopy region{0, offset + done, now};
      vkCmdCopyBuffer(commands, staging.state()->handle, state.handle, 1, &region);
    });
  }
}

void Device::download(const Buffer& buffer, void* data, uint64_t bytes, uint64_t offset) {
  checkRange(buffer, bytes, offset, "download");
  if (bytes == 0) return;
  BufferState& state = *buffer.state();
  if (state.mapped != nullptr) {
    if (deviceWrote(state.history)) {
      impl_->once([&](VkCommandBuffer commands) { transition(commands, state, kHostRead); });
    }
    std::memcpy(data, static_cast<const char*>(state.mapped) + offset, bytes);
    return;
  }
  const uint64_t piece = std::min(bytes, kStagingBytes);
  const Buffer staging = impl_->makeBuffer("download staging", piece, TexelFormat::None, MemoryUse::Readback);
  for (uint64_t done = 0; done < bytes; done += piece) {
    const uint64_t now = std::min(piece, bytes - done);
    impl_->once([&](VkCommandBuffer commands) {
      transition(commands, state, kTransferRead);
      transition(commands, *staging.state(), kTransferWrite);
      const VkBufferCopy region{offset + done, 0, now};
      vkCmdCopyBuffer(commands, state.handle, staging.state()->handle, 1, &region);
      transition(commands, *staging.state(), kHostRead);
    });
    std::memcpy(static_cast<char*>(data) + done, staging.state()->mapped, now);
  }
}

void Device::upload(const GpuImage& image, int layer, const void* data, uint64_t bytes) {
  ImageState& state = *image.state();
  const FormatInfo& format = formatInfo(state.desc.format);
  const uint64_t texels = static_cast<uint64_t>(state.desc.width) * static_cast<uint64_t>(state.desc.height);
  const uint64_t wanted = texels * static_cast<uint64_t>(format.bytes);
  const bool widen = state.desc.format == Format::RGBA16F && bytes == texels * 16;
  if ((bytes != wanted && !widen) || layer < 0 || layer >= state.desc.layers) {
    throw badInput(fmt::format("upload of {} bytes to layer {} of image \"{}\": it has {} layers of {} bytes", bytes,
                               layer, image.name(), state.desc.layers, wanted));
  }
  const Buffer staging = impl_->makeBuffer("staging of " + state.name, wanted, TexelFormat::None, MemoryUse::Upload);
  if (widen) {
    const auto* from = static_cast<const float*>(data);
    auto* to = static_cast<uint16_t*>(staging.state()->mapped);
    for (uint64_t i = 0; i < texels * 4; ++i) to[i] = glm::packHalf1x16(from[i]);
  } else {
    std::memcpy(staging.state()->mapped, data, bytes);
  }
  impl_->once([&](VkCommandBuffer commands) {
    transition(commands, state, kImageTransferWrite);
    const VkBufferImageCopy region = layerCopy(state, layer);
    vkCmdCopyBufferToImage(commands, staging.state()->handle, state.handle, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &region);
  });
}

void Device::generateMips(const GpuImage& image) {
  ImageState& state = *image.state();
  if (state.desc.mips < 2) return;
  impl_->once([&](VkCommandBuffer commands) {
    transition(commands, state, kImageTransferWrite);
    VkImageMemoryBarrier2 barrier = imageBarrier(state, {});
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    barrier.subresourceRange.levelCount = 1;
    VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    for (int mip = 0; mip < state.desc.mips; ++mip) {
      if (mip > 0) {
        const uint32_t layers = static_cast<uint32_t>(state.desc.layers);
        const auto side = [](int size, int level) { return std::max(size >> level, 1); };
        VkImageBlit blit{};
        blit.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, static_cast<uint32_t>(mip - 1), 0, layers};
        blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, static_cast<uint32_t>(mip), 0, layers};
        blit.srcOffsets[1] = {side(state.desc.width, mip - 1), side(state.desc.height, mip - 1), 1};
        blit.dstOffsets[1] = {side(state.desc.width, mip), side(state.desc.height, mip), 1};
        vkCmdBlitImage(commands, state.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, state.handle,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
      }
      barrier.subresourceRange.baseMipLevel = static_cast<uint32_t>(mip);
      vkCmdPipelineBarrier2(commands, &info);
    }
    state.history.layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  });
}

void Device::download(const GpuImage& image, void* data, uint64_t bytes) {
  const std::vector<char> raw = rawTexels(*impl_, *image.state());
  if (bytes != raw.size()) {
    throw badInput(
        fmt::format("download of {} bytes from image \"{}\", which has {}", bytes, image.name(), raw.size()));
  }
  std::memcpy(data, raw.data(), bytes);
}

Image Device::download(const GpuImage& image) {
  const FormatInfo& format = formatInfo(image.format());
  if (!format.floating)
    throw badInput(fmt::format("image \"{}\" is {}, not a float format", image.name(), format.name));
  const std::vector<char> raw = rawTexels(*impl_, *image.state());
  Image out(image.width(), image.height(), format.channels);
  if (image.format() == Format::RGBA16F) {
    for (size_t i = 0; i < out.data.size(); ++i) {
      uint16_t half;
      std::memcpy(&half, raw.data() + 2 * i, sizeof half);
      out.data[i] = glm::unpackHalf1x16(half);
    }
  } else {
    std::memcpy(out.data.data(), raw.data(), raw.size());
  }
  return out;
}

}  // namespace hl
