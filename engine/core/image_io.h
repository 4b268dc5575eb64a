#pragma once
// Image files. PFM is ours; EXR, PNG, JPEG and the rest go through OpenImageIO. Metadata is ASCII text attributes.
#include <filesystem>

#include "engine/core/image.h"

namespace hl {

/// 8- and 16-bit files come back as their stored values in [0, 1]; `srgbToLinear` undoes the sRGB curve for those (alpha untouched).
/// @throws Error(BadInput) naming the file, when it is missing, cut off or not an image.
Image readImage(const std::filesystem::path& file, bool srgbToLinear = false);

/// By extension: .exr (32-bit float) and .pfm take linear values; .png takes display values in [0, 1], 8 bit.
/// Written to a temporary file beside it and renamed, so that a cut never leaves half a file.
void writeImage(const std::filesystem::path& file, const Image& image);

}  // namespace hl
