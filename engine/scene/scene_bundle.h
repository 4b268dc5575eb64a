#pragma once
// Scenes in bundles: imported, complete, and found by the name or path that the packed preset calls them by.
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/archive.h"
#include "engine/scene/scene.h"
#include "engine/scene/scene_pack.h"

namespace hl {

/// A bundle (DESIGN.md section 9). Its version is also that of the scenes in it.
inline constexpr ArchiveKind kBundleKind{"bundle", kScenePackVersion};
inline constexpr const char* kBundleExtension = ".hlb";

bool isBundleFile(const std::filesystem::path&);
/// The part that holds scene `name`.
std::string bundledScenePart(const std::string& name);
std::vector<std::string> bundledScenes(const Archive&);
/// The name of its one scene. @throws Error(BadInput) where it has another number of them, naming them
std::string onlyScene(const Archive&);
/// @throws ArchiveError naming the file and what is wrong with it.
Scene bundledScene(const Archive&, const std::string& name);

}  // namespace hl
