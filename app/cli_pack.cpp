// `pack`: a preset with its scene, and its references where asked for, in one file for another machine.
#include <fmt/format.h>

#include <filesystem>

#include "app/cli_commands.h"
#include "engine/core/json_writer.h"
#include "engine/core/error.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/open_target.h"
#include "engine/scene/scene_file.h"

namespace hl::cli {
namespace {

namespace fs = std::filesystem;

Preset wantedPreset(const PackOptions& o) {
  Preset preset = openTarget(o.target);
  setResolution(preset, o.resolution);
  if (!o.camera.empty()) preset.cameraName = o.camera, preset.camera.reset();
  setParameters(preset, o.set);
  checkOutputImage("--out", o.out, {kBundleExtension});
  return preset;
}

/// Traced to the preset's settings, or taken from the cache: then their files are what travels.
std::vector<fs::path> referenceFiles(const GlobalOptions& global, const Preset& preset, Progress& progress) {
  Session session(global.session());
  session.load(preset, &progress);
  session.reference("image", &progress);
  return session.referenceFiles();
}

}  // namespace

int pack(const GlobalOptions& global, const PackOptions& o) {
  const Preset preset = wantedPreset(o);
  for (const std::string& w : preset.warnings) note(w);
  const auto progress = interruptibleProgress(global);
  const fs::path beside = isBundleFile(preset.file) ? preset.file : preset.file.parent_path();
  const Scene scene = loadScene(preset.scene, progress.get(), beside);
  for (const std::string& w : scene.report.warnings) note(w);
  BundleContent content{preset, {{preset.scene, &scene}}, {}};
  if (o.references) content.cached = referenceFiles(global, preset, *progress);
  progress->begin("pack", 1);
  writeBundle(o.out, content);
  finishProgress();

  const std::vector<BundlePart> parts = bundleParts(o.out);
  const uint64_t bytes = fs::file_size(o.out);
  if (global.json) {
    JsonWriter w;
    w.beginObject().member("file", o.out).member("bytes", bytes).member("scene_hash", scene.hash).key("parts").beginArray();
    for (const BundlePart& p : parts) w.beginObject().member("name", p.name).member("bytes", p.storedBytes).endObject();
    print(w.endArray().endObject().str() + "\n");
    return 0;
  }
  std::string text = fmt::format("{}: {:.2f} MB\n", o.out, static_cast<double>(bytes) / 1e6);
  for (const BundlePart& p : parts) text += fmt::format("  {:<60} {:>9.2f} MB\n", p.name, static_cast<double>(p.storedBytes) / 1e6);
  print(text);
  return 0;
}

}  // namespace hl::cli
