#pragma once
// What Assimp makes of a mesh file, in plain data. Assimp itself is in the import module alone (engine/import).
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/progress.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/scene.h"

namespace hl {

/// A material before its textures are loaded. Maps are file names relative to the mesh, or "*3" for the third embedded
/// image.
struct MaterialSource {
  Material material;
  std::string albedoMap, normalMap, alphaMap, emissiveMap;
};

struct EmbeddedImage {
  std::string extension;  ///< ".png"
  std::string bytes;
};

struct AssimpMesh {
  Scene scene;                            ///< geometry and objects; material ids count in `materials`
  std::vector<MaterialSource> materials;  ///< all of the file's
  std::vector<EmbeddedImage> images;
};

/// The import module's function. `bytes` is the content of `file`; buffers that a glTF keeps in other files are read from beside it and added to
/// `inputs`.
using ReadMeshEntry = AssimpMesh(const std::filesystem::path& file, std::string_view bytes, double scale, Progress*,
                                 std::vector<ImportInput>& inputs);

}  // namespace hl
