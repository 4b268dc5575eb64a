#pragma once
// GLSL to SPIR-V in process, for hot reload. Same language, target and include root as the build's own compilation.
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace hl {

struct CompiledShader {
  std::vector<uint32_t> words;  ///< empty where it did not compile
  std::string error;            ///< "file:line: message", one line each
};
/// The stage follows from the extension: .comp, .vert or .frag. Includes are looked for from `root`.
CompiledShader compileShader(const std::filesystem::path& source, const std::filesystem::path& root);

/// A source file and everything that it includes, with the hash of each one's content.
std::vector<std::pair<std::filesystem::path, std::string>> shaderDependencies(const std::filesystem::path& source,
                                                                              const std::filesystem::path& root);

}  // namespace hl
