#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_formats.h"

namespace hl {

namespace {

/// Takes the next word and the one white-space character after it, which is all that may stand before the pixels.
std::string_view takeWord(std::string_view& rest) {
  constexpr std::string_view kSpace = " \t\r\n";
  rest.remove_prefix(std::min(rest.find_first_not_of(kSpace), rest.size()));
  const std::string_view word = rest.substr(0, rest.find_first_of(kSpace));
  rest.remove_prefix(std::min(word.size() + 1, rest.size()));
  return word;
}

template <class T>
bool parse(std::string_view word, T& value) {
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  return problem == std::errc() && end == word.data() + word.size();
}

void swapBytes(std::vector<float>& values) {
  for (float& value : values) {
    const uint32_t bits = std::bit_cast<uint32_t>(value);
    value = std::bit_cast<float>(__builtin_bswap32(bits));
  }
}

}  // namespace

Image readPfm(const std::filesystem::path& file) {
  const std::string bytes = readFile(file);
  std::string_view rest = bytes;
  const std::string_view magic = takeWord(rest);
  const std::string_view width = takeWord(rest), height = takeWord(rest), scale = takeWord(rest);
  int w = 0, h = 0;
  float factor = 0;
  const int channels = magic == "PF" ? 3 : magic == "Pf" ? 1 : 0;
  if (channels == 0 || !parse(width, w) || !parse(height, h) || !parse(scale, factor) || w <= 0 || h <= 0 ||
      factor == 0 || !std::isfinite(factor))
    throw badInput(
        fmt::format("{}: not a portable float map (its header is 'PF' or 'Pf', width, height, scale)", file.string()));
  // Compared before anything is allocated: a wrong header must not ask for terabytes.
  const size_t rowBytes = static_cast<size_t>(w) * static_cast<size_t>(channels) * sizeof(float);
  if (rest.size() / rowBytes < static_cast<size_t>(h))
    throw badInput(fmt::format("{}: cut off: {} x {} pixels need {} bytes a row, {} are there in all", file.string(), w,
                               h, rowBytes, rest.size()));
  Image image(w, h, channels);
  for (int y = 0; y < h; ++y)  // rows are stored from the bottom
    std::memcpy(image.pixel(0, y), rest.data() + static_cast<size_t>(h - 1 - y) * rowBytes, rowBytes);
  const bool littleEndian = factor < 0;
  if (littleEndian != (std::endian::native == std::endian::little)) swapBytes(image.data);
  if (std::fabs(factor) != 1.0f)
    for (float& value : image.data) value *= std::fabs(factor);
  return image;
}

void writePfm(const std::filesystem::path& file, const Image& image) {
  if (image.channels != 1 && image.channels != 3)
    throw badInput(fmt::format("{}: a portable float map holds 1 or 3 channels, not {}; .exr holds any number",
                               file.string(), image.channels));
  const bool littleEndian = std::endian::native == std::endian::little;
  std::string bytes = fmt::format("{}\n{} {}\n{}\n", image.channels == 3 ? "PF" : "Pf", image.width, image.height,
                                  littleEndian ? "-1.0" : "1.0");
  const size_t rowBytes = static_cast<size_t>(image.width) * static_cast<size_t>(image.channels) * sizeof(float);
  bytes.reserve(bytes.size() + rowBytes * static_cast<size_t>(image.height));
  for (int y = image.height - 1; y >= 0; --y) bytes.append(reinterpret_cast<const char*>(image.pixel(0, y)), rowBytes);
  writeFileAtomically(file, bytes);
}

}  // namespace hl
