#include "engine/scene/scene_bundle.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "engine/scene/scene_build.h"

namespace hl {
namespace {

constexpr std::string_view kScenes = "scene/";

}  // namespace

bool isBundleFile(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == kBundleExtension;
}

std::string bundledScenePart(const std::string& name) { return fmt::format("{}{}", kScenes, name); }

std::vector<std::string> bundledScenes(const Archive& bundle) {
  std::vector<std::string> names;
  for (const std::string& part : bundle.parts())
    if (part.starts_with(kScenes)) names.push_back(part.substr(kScenes.size()));
  return names;
}

std::string onlyScene(const Archive& bundle) {
  const std::vector<std::string> names = bundledScenes(bundle);
  if (names.size() != 1)
    throw badInput(fmt::format("{}: it holds {} scenes ({}); one is wanted", bundle.file().string(), names.size(), fmt::join(names, ", ")));
  return names.front();
}

Scene bundledScene(const Archive& bundle, const std::string& name) {
  const std::string bytes = bundle.read(bundledScenePart(name));
  try {
    Scene scene = unpackScene(bytes);
    if (scene.cameras.empty() || scene.hash != sceneContentHash(scene)) throw std::out_of_range("content");
    scene.source = bundle.file();
    return scene;
  } catch (const std::exception&) {
    throw ArchiveError(ArchiveError::Reason::Damaged, fmt::format("{}: its scene {} is damaged; pack it again", bundle.file().string(), name));
  }
}

}  // namespace hl
