#pragma once
// A look through a glTF or glb file before Assimp gets it: every offset, count and index must lie inside what it refers to.
#include <filesystem>
#include <string_view>

#include "engine/core/progress.h"

namespace hl {

/// @throws Error(BadInput): "<file>: <place>: <what>".
void checkGltf(std::string_view bytes, const std::filesystem::path& file, Progress* = nullptr);

}  // namespace hl
