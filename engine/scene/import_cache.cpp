#include "engine/scene/mesh_import.h"

namespace hl {

Scene importMeshCached(const std::filesystem::path& file, double scale, Progress* progress) { return importMesh(file, scale, progress); }

}  // namespace hl
