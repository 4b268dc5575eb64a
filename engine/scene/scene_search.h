#pragma once
// Where scenes and their meshes are.
#include <filesystem>
#include <string>

#include "engine/scene/scene_description.h"

namespace hl {

/// The scene or mesh file that a name or path means. @throws Error(BadInput) saying where it was looked for, with the
/// nearest name.
std::filesystem::path findScene(const std::string& nameOrPath, const std::filesystem::path& beside);

/// A scene file's environment map, looked for as a mesh is. @throws Error(BadInput) saying where to get it.
std::filesystem::path findEnvironment(const EnvironmentReference&, const std::filesystem::path& sceneFile);

/// A scene file's mesh: beside the file, then along scenePath(). @throws Error(BadInput) saying where to get it.
std::filesystem::path findMesh(const MeshReference&, const std::filesystem::path& sceneFile);

}  // namespace hl
