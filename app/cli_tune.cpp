// `tune`: the least error within a time budget.
#include <fmt/format.h>

#include "app/cli_commands.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/experiment/experiment.h"
#include "engine/sweep/tune.h"

namespace hl::cli {

int tune(const GlobalOptions& global, const TuneArguments& o) {
  TuneOptions options;
  options.base = openTarget(o.target);
  for (const std::string& w : options.base.warnings) note(w);
  options.base.warnings.clear();
  for (const std::string& t : o.techniques) techniqueInfo(t);
  if (o.techniques.size() == 1) changeTechnique(options.base, o.techniques.front());
  setResolution(options.base, o.resolution);
  if (!o.camera.empty()) options.base.cameraName = o.camera, options.base.camera.reset();
  setParameters(options.base, o.set);
  for (const std::string& pair : o.set) options.fixed.insert(pair.substr(0, pair.find('=')));
  options.budgetMs = o.budgetMs, options.perFrame = o.perFrame, options.amortiseFrames = o.amortiseFrames;
  options.techniques = o.techniques;
  options.metric = o.metric, options.reference = o.reference;
  options.candidates = o.candidates, options.seed = o.seed;
  Tuner tuner(options, o.out);
  checkOutputFolder("--out", o.out);
  const auto progress = interruptibleProgress(global);
  Session session(global.session());
  session.useProgress(progress);
  if (!global.json) tuner.onStatus = showStatus;
  TuneResult result;
  try {
    result = tuner.run(session, *progress);
  } catch (const Error& e) {
    finishProgress();
    if (e.kind() != ErrorKind::Cancelled) throw;
    throw Error(ErrorKind::Cancelled, fmt::format("cancelled; what was measured is kept in {}: the same command goes on", o.out));
  }
  finishProgress();
  print(readFile(std::filesystem::path(o.out) / (global.json ? "tune.json" : "tune.md")));
  const int code = validationVerdict(global, session.device(), 0);
  if (!result.winner()) throw Error(ErrorKind::Run, fmt::format("nothing that was tried stays within {:g} ms", o.budgetMs));
  return code;
}

}  // namespace hl::cli
