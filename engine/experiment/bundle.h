#pragma once
// Bundles (.hlb): a preset with everything that it needs in one compressed file, for machines without the import module, the meshes or the cache.
#include <filesystem>
#include <string>
#include <vector>

#include "engine/experiment/preset.h"
#include "engine/scene/scene_bundle.h"

namespace hl {

struct BundleContent {
  Preset preset;
  std::vector<std::pair<std::string, const Scene*>> scenes;  ///< by the name or path that the preset has
  std::vector<std::filesystem::path> cached;                 ///< files in cacheFolder() that come along: references
};

/// Atomically. @throws Error(Run) where the file cannot be written.
void writeBundle(const std::filesystem::path&, const BundleContent&);

/// The preset, with `file` naming the bundle, so that its scene is found in there. References are put into cacheFolder() where they are not
/// there yet (a cache that cannot be written is a warning).
/// @throws ArchiveError naming the file and what is wrong with it.
Preset openBundle(const std::filesystem::path&);

/// What a bundle holds, for people: parts and their stored sizes.
struct BundlePart {
  std::string name;
  uint64_t storedBytes = 0;
};
std::vector<BundlePart> bundleParts(const std::filesystem::path&);

}  // namespace hl
