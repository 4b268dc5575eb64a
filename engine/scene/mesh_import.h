#pragma once
// Mesh files as the geometry, materials and textures of a scene.
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/scene/scene.h"

namespace hl {

/// A file that an import read, or looked for in vain; the import cache holds while all of them stay as they are.
struct ImportInput {
  std::filesystem::path file;
  std::string hash;  ///< of the content; "" where it was missing
};

/// OBJ (with MTL), glTF and glb. Positions are multiplied by `scale`; degenerate triangles are dropped and counted;
/// normals are generated where there are none; only materials and textures that triangles use come along.
/// @throws Error(BadInput): one line with the file and the place in it. @throws Error(Cancelled)
Scene importMesh(const std::filesystem::path& file, double scale, Progress*,
                 std::vector<ImportInput>* inputs = nullptr);

/// Whether the name ends like a mesh that importMesh reads.
bool isMeshFile(const std::filesystem::path& file);
inline constexpr const char* kMeshKinds = ".obj, .gltf, .glb";

/// The same through the cache in cacheFolder(): by content of the mesh file and `scale`; a file that is damaged, of
/// another version, or whose inputs have changed is made anew.
Scene importMeshCached(const std::filesystem::path& file, double scale, Progress*);
/// Where that cache keeps this mesh.
std::filesystem::path importCacheFile(const std::filesystem::path& file, double scale);

}  // namespace hl
