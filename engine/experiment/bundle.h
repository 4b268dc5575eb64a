#pragma once
// Bundles (.hlb): a preset or an experiment with everything that it needs in one compressed file, for machines without the import module, the meshes or the cache.
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "engine/experiment/experiment.h"
#include "engine/experiment/preset.h"
#include "engine/scene/scene_bundle.h"

namespace hl {

struct BundleContent {
  std::variant<Preset, Experiment> what;
  std::vector<std::pair<std::string, const Scene*>> scenes;  ///< by the name or path that the preset has
  std::vector<std::filesystem::path> cached;                 ///< files in cacheFolder() that come along: references
};

/// Atomically. @throws Error(Run) where the file cannot be written.
void writeBundle(const std::filesystem::path&, const BundleContent&);

enum class BundleKind { Preset, Experiment };
/// @throws ArchiveError naming the file and what is wrong with it.
BundleKind bundleKind(const std::filesystem::path&);

/// The preset, with `file` naming the bundle, so that its scene is found in there. References are put into cacheFolder() where they are not
/// there yet (a cache that cannot be written is a warning), each after checkReferenceFile().
/// @throws ArchiveError naming the file and what is wrong with it. Error(BadInput) where it holds an experiment.
Preset openBundle(const std::filesystem::path&);
/// Likewise the experiment; its base's `file` names the bundle. @throws Error(BadInput) where it holds a preset.
Experiment openExperimentBundle(const std::filesystem::path&);

/// What a bundle holds, for people: parts and their stored sizes.
struct BundlePart {
  std::string name;
  uint64_t storedBytes = 0;
};
std::vector<BundlePart> bundleParts(const std::filesystem::path&);

}  // namespace hl
