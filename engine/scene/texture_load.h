#pragma once
// Image files as the 8-bit textures of a scene.
#include <filesystem>
#include <string_view>

#include "engine/scene/scene.h"

namespace hl {

/// Textures with a longer side are reduced to it: every layer of the device's texture array has the size of the
/// largest.
inline constexpr int kMaxTextureSize = 1024;

/// @throws Error(BadInput) naming the file, where it is missing, cut off or no image.
Texture loadTexture(const std::filesystem::path& file, bool srgb);
/// An encoded image in memory (of a .glb). `name` is for messages, `extension` tells the kind (".png").
Texture loadTexture(std::string_view encoded, const std::string& name, const std::string& extension, bool srgb);

/// Puts the mask's opacity (its alpha channel where that varies, else its red one) into the alpha channel of `texture`.
void setAlpha(Texture& texture, const Texture& mask);

/// Area-weighted resampling, in linear light where the texture is sRGB.
Texture resampled(const Texture&, int width, int height);

}  // namespace hl
