#pragma once
// A whole scene as bytes: what the import cache and bundles hold.
#include <string>
#include <string_view>

#include "engine/scene/scene.h"

namespace hl {

/// Raised when the layout below, or what an import makes of a file, changes.
inline constexpr uint32_t kScenePackVersion = 6;

/// Everything but `source`.
std::string packScene(const Scene&);
/// @throws std::exception where the bytes are not what packScene made: too short, too long, or triangles, materials and textures that refer to what is
/// not there. Values are not judged: an archive's checksum has found damage before.
Scene unpackScene(std::string_view);

}  // namespace hl
