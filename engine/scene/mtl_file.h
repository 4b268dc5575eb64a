#pragma once
// Material libraries of OBJ files. Read by ourselves: Assimp passes over `norm` and tells no line numbers.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/math.h"

namespace hl {

struct MtlMaterial {
  std::string name;
  vec3 albedo{0.8f};    ///< Kd
  vec3 emission{0.0f};  ///< Ke
  std::string albedoMap, normalMap,
      alphaMap;                      ///< map_Kd; norm or map_Kn; map_d. Paths as written, with / for separators
  std::vector<std::string> ignored;  ///< keys that would change the look but are not read, e.g. map_Ke, bump
};

/// @throws Error(BadInput): "<file>:<line>: ..." for a value that is no finite number, is negative, or is missing.
std::vector<MtlMaterial> parseMtl(std::string_view text, const std::filesystem::path& file);

}  // namespace hl
