#pragma once
// Loading scenes: scene JSON, or a bare mesh (which then gets a camera and a light), through the import cache.
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/scene/scene.h"

namespace hl {

/// A scene name ("cornell_box"), a scene file, a mesh (.obj, .gltf, .glb), or a bundle of one scene. Names and relative paths are looked for along
/// scenePath(); where `beside` is a bundle, in there first.
/// @throws Error(BadInput): one line with the file, the place in it and what would be right.
/// @throws Error(Cancelled)
Scene loadScene(const std::string& nameOrPath, Progress* progress = nullptr, const std::filesystem::path& beside = {});

/// Writes a scene's changed lights, sky and cameras over its file's JSON (for "save scene as").
std::string sceneJson(const Scene&);

struct SceneListing {
  std::string id, label;
  std::filesystem::path file;
  bool available = true;   ///< false: its mesh is missing
  std::string missing;     ///< what is missing and where to get it
};
std::vector<SceneListing> listScenes();

/// A camera from which the whole of the scene (or, in a closed room, its inside) is seen.
Camera sensibleCamera(const Scene&);

}  // namespace hl
