#include "engine/core/image_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_formats.h"
#include "engine/core/import_module.h"

namespace hl {

namespace fs = std::filesystem;

namespace {

std::string extensionOf(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace

Image rgbOf(const Image& in) {
  if (in.channels == 3) return in;
  Image out(in.width, in.height, 3);
  const size_t stride = static_cast<size_t>(in.channels);
  for (size_t i = 0; i < in.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) out.data[i * 3 + c] = in.data[i * stride + (in.channels >= 3 ? c : 0)];
  return out;
}

Image readImage(const fs::path& file, bool srgbToLinear) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw badInput(fmt::format("{}: no such image", file.string()));
  if (!fs::is_regular_file(file, ignored)) throw badInput(fmt::format("{}: not an image file", file.string()));
  if (extensionOf(file) == ".pfm") return readPfm(file);
  return importEntry<ReadImageEntry>(ImportEntry::kReadImage, file.string())(file, srgbToLinear);
}

void writeImage(const fs::path& file, const Image& image) {
  const std::string extension = extensionOf(file);
  if (image.width <= 0 || image.height <= 0 || image.channels <= 0 ||
      image.data.size() != image.pixels() * static_cast<size_t>(image.channels))
    throw badInput(fmt::format("{}: an image of {} x {} pixels, {} channels and {} values cannot be written",
                               file.string(), image.width, image.height, image.channels, image.data.size()));
  if (extension == ".pfm") return writePfm(file, image);
  if (extension != ".exr" && extension != ".png")
    throw badInput(fmt::format("{}: images are written as .exr, .pfm or .png", file.string()));
  const auto write = importEntry<WriteImageEntry>(ImportEntry::kWriteImage, file.string());
  const fs::path temporary = temporaryBeside(file);
  try {
    write(temporary, file, image);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
  moveIntoPlace(temporary, file);
}

}  // namespace hl
