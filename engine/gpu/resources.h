#pragma once
// Buffers and images on the device: movable handles that free themselves. Vulkan's own types appear as opaque handles,
// so that users of the engine need no Vulkan header.
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "engine/core/image.h"

namespace hl {

class Device;
struct BufferState;  // what the device keeps about a buffer: handle, memory, mapping, last access
struct ImageState;

/// A buffer; copies of the handle share it. Usage is always storage + uniform + transfer + indirect (+ texel where a
/// texel format is given).
class Buffer {
 public:
  Buffer() = default;
  explicit operator bool() const { return state_ != nullptr; }
  uint64_t size() const;
  const std::string& name() const;
  BufferState* state() const { return state_.get(); }
  explicit Buffer(std::shared_ptr<BufferState> s) : state_(std::move(s)) {}

 private:
  std::shared_ptr<BufferState> state_;
};

enum class Format { R32F, RG32F, RGBA32F, RGBA16F, RGBA8, R32U, RG32U, RGBA32U, D32F };

/// A 2D image (or array) with one mip level unless said otherwise; storage + sampled + transfer, and attachment where
/// the format allows.
class GpuImage {
 public:
  GpuImage() = default;
  explicit operator bool() const { return state_ != nullptr; }
  int width() const;
  int height() const;
  Format format() const;
  const std::string& name() const;
  ImageState* state() const { return state_.get(); }
  explicit GpuImage(std::shared_ptr<ImageState> s) : state_(std::move(s)) {}

 private:
  std::shared_ptr<ImageState> state_;
};

struct ImageDesc {
  int width = 1, height = 1;
  Format format = Format::RGBA32F;
  int layers = 1;  ///< > 1: a 2D-array view
  int mips = 1;
  bool operator==(const ImageDesc&) const = default;
};

using Texture2dArray = GpuImage;  ///< with a layer count; bound as a sampler2DArray

enum class TexelFormat { None, RGBA32F };

}  // namespace hl
