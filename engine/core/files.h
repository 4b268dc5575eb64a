#pragma once
// Files read whole and written atomically, and where the program's own files are.
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hl {

/// @throws Error(BadInput) naming the file.
std::string readFile(const std::filesystem::path& file);

/// Temporary file beside it, fsync, rename. @throws Error(Run) with the system's reason.
void writeFileAtomically(const std::filesystem::path& file, std::string_view bytes);

/// The two halves of the above, for writers that need a file's name: a fresh name beside `file` with its extension, and fsync and rename
/// of what was written there. @throws Error(Run), with the temporary file removed.
std::filesystem::path temporaryBeside(const std::filesystem::path& file);
void moveIntoPlace(const std::filesystem::path& temporary, const std::filesystem::path& file);

/// The running program's own folder, or the current one where the system does not say.
std::filesystem::path programFolder();
/// The folder that holds shaders/, scenes/ and presets/: HALFLIGHT_HOME where set, else the source tree the program was built from,
/// else beside the executable.
std::filesystem::path homeFolder();
/// Folder of compiled shaders (.spv): HALFLIGHT_SHADERS where set, else the build's.
std::filesystem::path shaderFolder();
/// XDG_CACHE_HOME/halflight, or HALFLIGHT_CACHE; created on first use.
std::filesystem::path cacheFolder();
/// Meshes and scenes are looked for in these, in order: `beside`, then HALFLIGHT_SCENES (a path list), then homeFolder()/scenes.
std::vector<std::filesystem::path> scenePath(const std::filesystem::path& beside = {});

}  // namespace hl
