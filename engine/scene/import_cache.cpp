// The import cache: one archive a mesh, holding what the import made and the hashes of every file it read.
#include <fmt/format.h>

#include <optional>

#include "engine/core/archive.h"
#include "engine/core/byte_stream.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/scene_pack.h"

namespace hl {
namespace {

constexpr ArchiveKind kKind{"import", kScenePackVersion};
constexpr int kLevel = 1;  // read more often than written, and never sent anywhere
constexpr const char* kInputs = "inputs";
constexpr const char* kScene = "scene";

std::string packInputs(const std::vector<ImportInput>& inputs, const std::filesystem::path& folder) {
  ByteWriter w;
  w.value<uint64_t>(inputs.size());
  for (const ImportInput& i : inputs) {
    const std::filesystem::path relative = i.file.lexically_relative(folder);
    w.text((relative.empty() ? i.file : relative).generic_string()), w.text(i.hash);
  }
  return w.take();
}

/// Whether every file that the import read, or looked for in vain, still is as it was.
bool inputsUnchanged(std::string_view bytes, const std::filesystem::path& folder) {
  ByteReader r(bytes);
  for (size_t n = r.count(1); n > 0; --n) {
    const std::filesystem::path file = folder / r.text();
    const std::string hash = r.text();
    const bool there = std::filesystem::is_regular_file(file);
    if (there != !hash.empty() || (there && hashOf(readFile(file)) != hash)) return false;
  }
  return true;
}

/// The scene in the cache file; nothing where there is none, where it is damaged or foreign, or where an input changed.
std::optional<Scene> fromCache(const std::filesystem::path& cached, const std::filesystem::path& folder) {
  if (!std::filesystem::is_regular_file(cached)) return {};
  try {
    const Archive archive(cached, kKind);
    if (!inputsUnchanged(archive.read(kInputs), folder)) return {};
    return unpackScene(archive.read(kScene));
  } catch (const ArchiveError& e) {
    if (e.reason() == ArchiveError::Reason::OtherVersion) return {};
  } catch (const std::exception&) {
  }
  logWarning(fmt::format("{}: damaged or foreign; the mesh is imported again", cached.string()));
  return {};
}

}  // namespace

std::filesystem::path importCacheFile(const std::filesystem::path& file, double scale) {
  const std::string content = hashOf(readFile(file));
  Hasher h;
  h.text(content).value(scale).value(kScenePackVersion).text(file.extension().string());
  return cacheFolder() / "import" / (h.hex() + ".hlmesh");
}

Scene importMeshCached(const std::filesystem::path& file, double scale, Progress* progress) {
  if (!isMeshFile(file)) return importMesh(file, scale, progress);  // for its message
  const std::filesystem::path cached = importCacheFile(file, scale), folder = file.parent_path();
  if (progress) progress->begin("import: look in the cache", 1);
  if (std::optional<Scene> scene = fromCache(cached, folder)) return std::move(*scene);
  std::vector<ImportInput> inputs;
  Scene scene = importMesh(file, scale, progress, &inputs);
  try {
    std::filesystem::create_directories(cached.parent_path());
    ArchiveWriter archive(kKind, kLevel);
    archive.add(kInputs, packInputs(inputs, folder));
    archive.add(kScene, packScene(scene));
    archive.write(cached);
  } catch (const std::exception& e) {
    logWarning(fmt::format("the import cache cannot be written: {}", e.what()));  // the scene is there all the same
  }
  return scene;
}

}  // namespace hl
