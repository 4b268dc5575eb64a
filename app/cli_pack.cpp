// `pack`: a preset or an experiment with its scene, and its references where asked for, in one file for another machine.
#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "app/cli_commands.h"
#include "engine/core/error.h"
#include "engine/core/json_writer.h"
#include "engine/experiment/bundle.h"
#include "engine/experiment/experiment.h"
#include "engine/experiment/open_target.h"
#include "engine/scene/scene_file.h"

namespace hl::cli {
namespace {

namespace fs = std::filesystem;

/// What the bundle is of. Options change the preset, or what the experiment varies.
struct Wanted {
  std::variant<Preset, Experiment> what;
  Preset& base() { return std::holds_alternative<Preset>(what) ? std::get<Preset>(what) : std::get<Experiment>(what).base; }
};

Wanted wantedTarget(const PackOptions& o) {
  Wanted out;
  if (isExperiment(o.target))
    out.what = openExperiment(o.target);
  else
    out.what = openTarget(o.target);
  Preset& base = out.base();
  const std::vector<std::string>& warnings = std::holds_alternative<Preset>(out.what) ? base.warnings : std::get<Experiment>(out.what).warnings;
  for (const std::string& w : warnings) note(w);
  setResolution(base, o.resolution);
  if (!o.camera.empty()) base.cameraName = o.camera, base.camera.reset();
  setParameters(base, o.set);
  checkOutputImage("--out", o.out, {kBundleExtension});
  return out;
}

/// Those that runs are measured against, each once.
std::vector<Preset> referencedBy(const Wanted& wanted) {
  if (const auto* preset = std::get_if<Preset>(&wanted.what)) return {*preset};
  std::vector<Preset> out;
  std::set<std::string> known;
  for (const Configuration& c : configurationsOf(std::get<Experiment>(wanted.what)))
    if (known.insert(referenceProblem(c.preset)).second) out.push_back(c.preset);
  return out;
}

/// Traced to the presets' settings, or taken from the cache: then their files are what travels.
std::vector<fs::path> referenceFiles(const GlobalOptions& global, const std::vector<Preset>& presets, const std::shared_ptr<const Scene>& scene, Progress& progress) {
  Session session(global.session());
  std::set<fs::path> files;  // configurations share theirs
  for (const Preset& preset : presets) {
    session.load(preset, &progress, scene);
    session.reference("image", &progress);
    for (const fs::path& file : session.referenceFiles()) files.insert(file);
  }
  return {files.begin(), files.end()};
}

}  // namespace

int pack(const GlobalOptions& global, const PackOptions& o) {
  Wanted wanted = wantedTarget(o);
  const auto progress = interruptibleProgress(global);
  const Preset& base = wanted.base();
  const fs::path beside = isBundleFile(base.file) ? base.file : base.file.parent_path();
  const auto scene = std::make_shared<const Scene>(loadScene(base.scene, progress.get(), beside));
  for (const std::string& w : scene->report.warnings) note(w);
  BundleContent content{wanted.what, {{base.scene, scene.get()}}, {}};
  if (o.references) content.cached = referenceFiles(global, referencedBy(wanted), scene, *progress);
  progress->begin("pack", 1);
  writeBundle(o.out, content);
  finishProgress();

  const std::vector<BundlePart> parts = bundleParts(o.out);
  const uint64_t bytes = fs::file_size(o.out);
  if (global.json) {
    JsonWriter w;
    w.beginObject().member("file", o.out).member("bytes", bytes).member("scene_hash", scene->hash).key("parts").beginArray();
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
