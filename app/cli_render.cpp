// `render`: a preset, scene or mesh until it has settled, with timings, errors and images.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "app/cli_commands.h"
#include "app/cli_results.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_io.h"
#include "engine/core/import_module.h"
#include "engine/experiment/experiment.h"
#include "engine/experiment/open_target.h"

namespace hl::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kMostStepFrames = 10'000;

/// The preset that the command line asks for, checked before any device is touched.
Preset wantedPreset(const RenderOptions& o) {
  Preset preset = openTarget(o.target);
  if (!o.technique.empty()) changeTechnique(preset, o.technique);
  setResolution(preset, o.resolution);
  if (o.seed) preset.seed = *o.seed;
  if (!o.camera.empty()) preset.cameraName = o.camera, preset.camera.reset();
  if (!o.camera.empty()) preset.animation.cameraPath.clear();
  if (o.play) preset.animation.play = true;
  if (o.time) preset.animation.start = *o.time;
  if (o.rate) preset.animation.rate = *o.rate;
  if (!o.cameraPath.empty()) preset.animation.cameraPath = o.cameraPath;
  if (!o.view.empty()) preset.display.view = o.view;
  if (o.exposure) preset.display.exposure = *o.exposure;
  setParameters(preset, o.set);
  checkMetrics(o.metrics);
  for (const std::string& target : o.errorTargets)
    if (target != "image" && target != "lightmap")
      throw badInput(fmt::format("--errors-of {}: image or lightmap is wanted", target));
  if (!o.step.empty() && parseStep(o.step).ofParameter()) {
    Preset stepped = preset;
    setParameters(stepped, {o.step});
  }
  if (!o.out.empty()) checkOutputFolder("--out", o.out);
  return preset;
}

std::shared_ptr<const FrameResult> renderFrames(Session& session, int frames, Progress& progress) {
  std::shared_ptr<const FrameResult> result;
  for (int i = 0; i < frames; ++i) {
    progress.check();
    result = session.frame(&progress);
  }
  progress.check();
  return result;
}

/// After a cancellation: one more frame of what is there, with nothing else going on.
std::shared_ptr<const FrameResult> frameAsItStands(Session& session) {
  Progress calm;
  session.cancelWork();
  session.setWorkPaused(true);
  return session.frame(&calm);
}

class Folder {
 public:
  Folder(const std::string& path, RunResults& results) : path_(path), results_(results) {
    std::error_code failed;
    fs::create_directories(path_, failed);
    if (failed) throw badInput(fmt::format("--out {}: the folder cannot be made: {}", path, failed.message()));
    results_.folder = path;
  }
  void image(Session& session, const char* view, const std::string& name) { write(session.image(view), name, ".exr"); }
  void picture() {
    const FrameResult& f = *results_.frame;
    Image image(f.width, f.height, 3);
    for (size_t i = 0; i < image.pixels(); ++i)
      for (size_t c = 0; c < 3; ++c) image.data[i * 3 + c] = static_cast<float>(f.display[i * 4 + c]) / 255.0f;
    write(std::move(image), "picture", ".png");
  }
  void results() {
    results_.files.emplace_back("result.json");
    writeFileAtomically(path_ / "result.json", resultsJson(results_));
  }

 private:
  /// As .pfm (three channels, nothing beside them) where the module that writes other formats is not there.
  void write(Image image, const std::string& name, const char* extension) {
    image.metadata = attributes();
    const bool plain = !importMissing().empty();
    const std::string file = name + (plain ? ".pfm" : extension);
    writeImage(path_ / file, plain ? rgbOf(image) : image);
    results_.files.push_back(file);
  }
  std::map<std::string, std::string> attributes() const {
    return imageAttributes(results_.frame->preset, results_.frame->provenance);
  }
  fs::path path_;
  RunResults& results_;
};

void writeOut(Session& session, Folder& folder) {
  folder.picture();
  folder.image(session, "final", "final");
  folder.image(session, "indirect", "indirect");
  folder.image(session, "indirect_irradiance", "indirect_irradiance");
  const bool glossy = session.features().glossySurfaces;
  if (glossy) folder.image(session, "specular", "indirect_specular"), folder.image(session, "direct_specular", "direct_specular");
  if (session.currentReference()) {
    folder.image(session, "reference", "reference");
    folder.image(session, "reference_indirect", "reference_indirect_irradiance");
    if (glossy) folder.image(session, "reference_specular", "reference_indirect_specular");
  }
}

/// The errors of the run, with the references that they need.
void measureRun(Session& session, const RenderOptions& o, RunResults& results, Progress& progress) {
  for (const std::string& target : o.errorTargets) {
    session.reference(target, &progress);
    const std::vector<ErrorValue> errors = session.measureErrors(o.metrics, target);
    results.errors.insert(results.errors.end(), errors.begin(), errors.end());
  }
}

void followStep(Session& session, const RenderOptions& o, RunResults& results, Progress& progress) {
  try {
    results.step.emplace(o.step, session.measureStep(parseStep(o.step), kMostStepFrames, &progress));
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::Cancelled) throw;
    results.cancelled = true;
  }
}

bool wantsImageErrors(const RenderOptions& o) {
  return !o.metrics.empty() && std::find(o.errorTargets.begin(), o.errorTargets.end(), "image") != o.errorTargets.end();
}

uint64_t nonFinitePixels(const std::vector<ErrorValue>& errors) {
  uint64_t most = 0;
  for (const ErrorValue& e : errors) most = std::max(most, e.nonFinite);
  return most;
}

}  // namespace

int render(const GlobalOptions& global, const RenderOptions& o) {
  const Preset preset = wantedPreset(o);
  for (const std::string& w : preset.warnings) note(w);
  const auto progress = interruptibleProgress(global);
  Session session(global.session());
  session.useProgress(progress);
  sayRebuilds(global, session);
  session.load(preset, progress.get());
  for (const std::string& w : session.scene().report.warnings) note(w);

  if (!o.step.empty()) session.checkStep(parseStep(o.step));

  RunResults results;
  try {
    // With the truth at hand from the start, the error is followed while the technique works.
    if (!o.frames && wantsImageErrors(o)) {
      session.reference("image", progress.get());
      session.setReferenceWanted(true);
    }
    results.frame = o.frames ? renderFrames(session, *o.frames, *progress) : session.settle(progress.get());
    if (!o.metrics.empty()) measureRun(session, o, results, *progress);
    if (o.flicker) {
      const std::vector<ErrorValue> flicker = session.measureFlicker(*o.flicker, progress.get());
      results.errors.insert(results.errors.end(), flicker.begin(), flicker.end());
    }
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::Cancelled) throw;
    results.cancelled = true;
    results.frame = frameAsItStands(session);
  }
  finishProgress();
  if (results.frame->techniqueFailed && results.frame->failure == ErrorKind::BadInput) throw badInput(results.frame->message);
  results.imageHash = hashOfImage(session.image("final"));
  std::optional<Folder> folder;
  if (!o.out.empty()) writeOut(session, folder.emplace(o.out, results));
  // Last, since it leaves another picture behind.
  if (!o.step.empty() && !results.cancelled) followStep(session, o, results, *progress);
  if (folder) folder->results();
  print(global.json ? resultsJson(results) : resultsText(results));

  if (results.cancelled) throw Error(ErrorKind::Cancelled, "cancelled; what was done is kept");
  if (results.frame->techniqueFailed) throw Error(results.frame->failure, results.frame->message);
  if (const uint64_t pixels = nonFinitePixels(results.errors))
    throw Error(ErrorKind::Run, fmt::format("{} pixels are NaN or infinite: the comparison fails", pixels));
  return validationVerdict(global, session.device(), 0);
}

}  // namespace hl::cli
