#pragma once
// A float image in memory: rows from the top, channels interleaved, linear and scene-referred unless said otherwise.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace hl {

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> data;                      ///< width * height * channels
  std::map<std::string, std::string> metadata;  ///< text attributes that a file carried, or that it will carry

  Image() = default;
  Image(int w, int h, int c) : width(w), height(h), channels(c), data(static_cast<size_t>(w) * h * c, 0.0f) {}
  size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  float* pixel(int x, int y) { return data.data() + (static_cast<size_t>(y) * width + x) * channels; }
  const float* pixel(int x, int y) const { return data.data() + (static_cast<size_t>(y) * width + x) * channels; }
};

/// Three channels: grey as three equal ones, alpha left out; metadata stays where nothing changes.
Image rgbOf(const Image&);

/// 1 where a pixel counts, 0 where not. Empty means every pixel counts.
using Mask = std::vector<unsigned char>;

}  // namespace hl
