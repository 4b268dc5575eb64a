#pragma once
// The two wrappings of glTF: JSON text, and glb with JSON and binary chunks.
#include <filesystem>
#include <string>
#include <string_view>

namespace hl {

struct GltfContainer {
  std::string_view json, chunk;
  bool binary = false, hasChunk = false;
};

/// @throws Error(BadInput) for a glb whose header or chunks do not fit its size.
GltfContainer openGltf(std::string_view bytes, const std::filesystem::path& file);
/// The same file with other JSON.
std::string wrapGltf(const GltfContainer&, std::string json);

/// The data of a "data:...;base64,..." URI. False where it is none.
bool decodeDataUri(std::string_view uri, std::string& out);

}  // namespace hl
