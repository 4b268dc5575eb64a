#pragma once
// A look through an OBJ file before Assimp gets it: Assimp takes NaN, half lines and faces of two corners without a
// word.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/progress.h"

namespace hl {

struct ObjSummary {
  std::vector<std::string> materialLibraries;  ///< as `mtllib` lines name them
  std::vector<std::string> materials;          ///< of `usemtl`, in order of first use
  uint64_t vertices = 0, uvs = 0, normals = 0, faces = 0;
};

/// @throws Error(BadInput): "<file>:<line>: <what>" for a coordinate that is no finite number, a vertex or face with
/// too few of them, an index out of range; "<file>: ..." for a file without faces.
ObjSummary checkObj(std::string_view text, const std::filesystem::path& file, Progress* = nullptr);

}  // namespace hl
