#pragma once
// The formats behind readImage and writeImage: one function pair a library.
#include <filesystem>

#include "engine/core/image.h"

namespace hl {

/// Portable float map: 1 or 3 channels, no metadata.
Image readPfm(const std::filesystem::path& file);
void writePfm(const std::filesystem::path& file, const Image& image);

/// Every other format is the import module's (engine/import). `to` is written as it is; `shown` is the name that messages give.
using ReadImageEntry = Image(const std::filesystem::path& file, bool srgbToLinear);
using WriteImageEntry = void(const std::filesystem::path& to, const std::filesystem::path& shown, const Image& image);

}  // namespace hl
