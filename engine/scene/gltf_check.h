#pragma once
// A look through a glTF or glb file before Assimp gets it: every offset, count and index must lie inside what it refers
// to, and every value must have its type. Assimp believes the file in most of these.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/progress.h"

namespace hl {

/// The same file with only the keys that were checked: geometry, nodes, and the parts of materials that are used. What
/// would change the look or the shape and is not read (skins, morph targets, sparse accessors, texture transforms) is
/// refused; KHR_materials_emissive_strength is multiplied into the emission. @throws Error(BadInput): "<file>: <place>:
/// <what>".
/// `warnings`: what is passed over and would change the look, one line each.
std::string checkGltf(std::string_view bytes, const std::filesystem::path& file, Progress* = nullptr, std::vector<std::string>* warnings = nullptr);

}  // namespace hl
