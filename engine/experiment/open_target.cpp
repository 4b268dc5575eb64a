#include "engine/experiment/open_target.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_io.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/json_reader.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/metrics/metrics.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& file) {
  std::string e = file.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}

Preset withScene(const std::string& scene) {
  Preset preset;
  preset.scene = scene;
  return preset;
}

Preset presetOfImage(const fs::path& file) {
  const Image image = readImage(file);
  const auto found = image.metadata.find(kPresetAttribute);
  if (found == image.metadata.end())
    throw badInput(fmt::format("{}: this image carries no preset; those that Halflight writes do", file.string()));
  return presetFromJson(found->second, file.string());
}

}  // namespace

Preset openTarget(const std::string& nameOrPath) {
  const fs::path path(nameOrPath);
  const std::string extension = lowerExtension(path);
  // A folder beside the person may have a scene's name: only a path is taken for a folder.
  if (fs::is_directory(path) && path.has_parent_path())
    throw badInput(fmt::format("{}: this is a folder; a preset, scene, mesh or image is wanted", nameOrPath));
  if (isBundleFile(path)) return openBundle(path);
  if (extension == ".png" || extension == ".exr") return presetOfImage(path);
  if (extension == ".json" && fs::exists(path)) {
    // Only a preset names a scene; only a scene has a mesh or shapes.
    const nlohmann::json document = parseStrictJson(readFile(path), nameOrPath);
    if (document.is_object() && document.contains("scene")) return loadPreset(path);
    if (document.is_object() && document.contains("base"))
      throw badInput(fmt::format("{}: this is an experiment, which `halflight-cli bench` runs; a preset, scene, mesh, bundle or image is wanted", nameOrPath));
    const bool scene = document.is_object() && (document.contains("mesh") || document.contains("shapes") ||
                                                document.contains("lights") || document.contains("cameras"));
    if (!scene && document.is_object() && (document.contains("technique") || document.contains("parameters")))
      return loadPreset(path);  // which says what is missing
  }
  if (extension.empty() && !fs::is_regular_file(path))
    for (const PresetListing& listing : listPresets())
      if (listing.id == nameOrPath) return loadPreset(listing.file);
  return withScene(nameOrPath);
}

void checkParameters(const Preset& preset) {
  const auto groups = parameterGroups(preset.technique);
  for (const auto& [key, text] : preset.parameters) {
    const ParamInfo* info = findParameter(groups, key);
    if (!info) {
      const std::string near = nearestParameter(groups, key);
      throw badInput(
          fmt::format("unknown parameter \"{}\" of technique {}; {}", key, preset.technique,
                      near.empty() ? "`halflight-cli list params` shows all" : fmt::format("did you mean {}?", near)));
    }
    parseParam(*info, text);
  }
}

void checkMetrics(const std::vector<std::string>& metrics) {
  std::vector<std::string> known;
  for (const MetricInfo& m : metricInfos()) known.emplace_back(m.id);
  for (const std::string& m : metrics) {
    if (std::find(known.begin(), known.end(), m) != known.end()) continue;
    const std::string near = nearest(m, known);
    throw badInput(fmt::format("unknown metric {}; {}there are {}", m,
                               near.empty() ? "" : fmt::format("did you mean {}? ", near), fmt::join(known, ", ")));
  }
}

}  // namespace hl
