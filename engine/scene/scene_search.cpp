#include "engine/scene/scene_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/scene_bundle.h"
#include "engine/scene/scene_file.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

bool isFile(const fs::path& p) {
  std::error_code ignored;
  return fs::is_regular_file(p, ignored);
}

std::string list(const std::vector<fs::path>& folders) {
  std::string text;
  for (const fs::path& f : folders) text += fmt::format("{}{}", text.empty() ? "" : ", ", f.string());
  return text;
}

std::string label(const SceneDescription& d, const fs::path& file) {
  return d.label.empty() ? file.stem().string() : d.label;
}

}  // namespace

fs::path findScene(const std::string& nameOrPath, const fs::path& beside) {
  if (nameOrPath.empty()) throw badInput("a scene's name or file is wanted, not an empty one");
  const fs::path asked(nameOrPath);
  const bool known = asked.extension() == ".json" || isMeshFile(asked) || isBundleFile(asked);
  const std::vector<fs::path> folders = scenePath(beside);
  if (known) {
    if (isFile(asked)) return asked;
    if (asked.is_relative())
      for (const fs::path& folder : folders)
        if (isFile(folder / asked)) return folder / asked;
    throw badInput(fmt::format("{}: no such file{}", nameOrPath,
                               asked.is_relative() ? "; looked in the current folder, " + list(folders) : ""));
  }
  if (isFile(asked))
    throw badInput(
        fmt::format("{}: neither a scene file (.json) nor a mesh that is read ({}) nor a bundle ({})", nameOrPath, kMeshKinds, kBundleExtension));
  for (const fs::path& folder : folders)
    for (const char* extension : {".json", kBundleExtension}) {
      const fs::path file = folder / (nameOrPath + extension);
      if (isFile(file)) return file;
    }
  std::vector<std::string> names;
  for (const SceneListing& s : listScenes()) names.push_back(s.id);
  const std::string near = nearest(nameOrPath, names);
  throw badInput(fmt::format("there is no scene '{}'{}; looked in {}", nameOrPath,
                             near.empty() ? "" : fmt::format("; did you mean '{}'?", near), list(folders)));
}

namespace {

fs::path findFile(const char* what, const std::string& file, const std::string& obtain, const fs::path& sceneFile) {
  const fs::path asked(file);
  if (asked.is_absolute() && isFile(asked)) return asked;
  const fs::path here = sceneFile.parent_path() / asked;
  if (isFile(here)) return here;
  const std::vector<fs::path> folders = scenePath(sceneFile.parent_path());
  if (asked.is_relative())
    for (const fs::path& folder : folders)
      if (isFile(folder / asked)) return folder / asked;
  throw badInput(fmt::format("{}: its {} '{}' is missing{}; looked in {} (HALFLIGHT_SCENES adds folders)", sceneFile.string(), what, file,
                             obtain.empty() ? "" : "; get it from " + obtain, list(folders)));
}

}  // namespace

fs::path findMesh(const MeshReference& mesh, const fs::path& sceneFile) { return findFile("mesh", mesh.file, mesh.obtain, sceneFile); }
fs::path findEnvironment(const EnvironmentReference& e, const fs::path& sceneFile) { return findFile("environment map", e.file, e.obtain, sceneFile); }

std::vector<SceneListing> listScenes() {
  std::vector<SceneListing> scenes;
  for (const fs::path& folder : scenePath()) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const fs::path file = entry.path();
      const std::string id = file.stem().string();
      if ((file.extension() != ".json" && !isBundleFile(file)) || !entry.is_regular_file(ignored)) continue;
      if (std::any_of(scenes.begin(), scenes.end(), [&](const SceneListing& s) { return s.id == id; })) continue;
      SceneListing s{id, id, file, true, ""};
      try {
        if (isBundleFile(file)) {
          onlyScene(Archive(file, kBundleKind));
          scenes.push_back(std::move(s));
          continue;
        }
        const SceneDescription d = parseSceneDescription(readFile(file), file);
        s.label = label(d, file);
        if (d.mesh) findMesh(*d.mesh, file);
        if (d.environment) findEnvironment(*d.environment, file);
      } catch (const Error& e) {
        s.available = false, s.missing = e.what();
      }
      scenes.push_back(std::move(s));
    }
  }
  std::sort(scenes.begin(), scenes.end(), [](const SceneListing& a, const SceneListing& b) { return a.id < b.id; });
  return scenes;
}

}  // namespace hl
