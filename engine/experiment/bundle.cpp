#include "engine/experiment/bundle.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/files.h"
#include "engine/core/log.h"
#include "engine/reference/reference_state.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

constexpr const char *kPreset = "preset", *kExperiment = "experiment";
constexpr std::string_view kCache = "cache/";
constexpr const char* kReferences = "references";
constexpr int kLevel = 12;  // Sponza: 17.0 MB, 2 s; level 19 gives 15.3 and takes 20 s

/// "cache/references/NAME", and nothing that could leave the cache's folder.
bool isReferencePart(std::string_view part) {
  const std::string prefix = fmt::format("{}{}/", kCache, kReferences);
  if (!part.starts_with(prefix)) return false;
  const std::string_view name = part.substr(prefix.size());
  return !name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '_' || c == '.';
  });
}

void fillCache(const Archive& bundle) {
  for (const std::string& part : bundle.parts()) {
    if (!isReferencePart(part)) continue;
    const fs::path file = cacheFolder() / part.substr(kCache.size());
    if (fs::exists(file)) continue;
    const std::string bytes = bundle.read(part);
    try {
      checkReferenceFile(file.filename().string(), bytes);
    } catch (const Error& e) {
      throw ArchiveError(ArchiveError::Reason::Damaged, fmt::format("{}: its reference {} is not to be trusted: {}; pack it again", bundle.file().string(), part, e.what()));
    }
    try {
      fs::create_directories(file.parent_path());
      writeFileAtomically(file, bytes);
    } catch (const std::exception& e) {
      logWarning(fmt::format("{}: its references cannot be put into the cache: {}", bundle.file().string(), e.what()));
      return;
    }
  }
}

}  // namespace

void writeBundle(const fs::path& file, const BundleContent& content) {
  ArchiveWriter archive(kBundleKind, kLevel);
  if (const auto* preset = std::get_if<Preset>(&content.what))
    archive.add(kPreset, presetJson(*preset));
  else
    archive.add(kExperiment, experimentJson(std::get<Experiment>(content.what)));
  for (const auto& [name, scene] : content.scenes) archive.add(bundledScenePart(name), packScene(*scene));
  for (const fs::path& cached : content.cached)
    archive.add(fmt::format("{}{}/{}", kCache, kReferences, cached.filename().string()), readFile(cached));
  archive.write(file);
}

BundleKind bundleKind(const fs::path& file) { return Archive(file, kBundleKind).has(kExperiment) ? BundleKind::Experiment : BundleKind::Preset; }

Preset openBundle(const fs::path& file) {
  const Archive bundle(file, kBundleKind);
  if (bundle.has(kExperiment)) throw badInput(fmt::format("{}: this bundle holds an experiment, which `halflight-cli bench` runs; one of a preset is wanted", file.string()));
  Preset preset = presetFromJson(bundle.read(kPreset), file.string());
  preset.file = file;
  fillCache(bundle);
  return preset;
}

Experiment openExperimentBundle(const fs::path& file) {
  const Archive bundle(file, kBundleKind);
  if (!bundle.has(kExperiment)) throw badInput(fmt::format("{}: this bundle holds a preset, which `halflight-cli render` runs; one of an experiment is wanted", file.string()));
  Experiment experiment = experimentFromJson(bundle.read(kExperiment), file);
  fillCache(bundle);
  return experiment;
}

std::vector<BundlePart> bundleParts(const fs::path& file) {
  const Archive bundle(file, kBundleKind);
  std::vector<BundlePart> parts;
  for (const std::string& name : bundle.parts()) parts.push_back({name, bundle.storedBytes(name)});
  return parts;
}

}  // namespace hl
