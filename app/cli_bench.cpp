// `bench`: an experiment's runs, into a folder of results.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "app/cli_commands.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/sweep/results_folder.h"
#include "engine/sweep/sweep.h"

namespace hl::cli {
namespace {

std::string timeText(double seconds) {
  if (seconds < 0) return "";
  if (seconds < 100) return fmt::format(", about {:.0f} s left", seconds);
  return seconds < 6000 ? fmt::format(", about {:.0f} min left", seconds / 60) : fmt::format(", about {:.1f} h left", seconds / 3600);
}

}  // namespace

void showStatus(const SweepStatus& s) {
  const std::string line = fmt::format("{}[{}/{}{}] {}{}\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", s.done, s.total,
                                       s.failed ? fmt::format(", {} failed", s.failed) : "", s.doing, timeText(s.secondsLeft));
  std::fputs(line.c_str(), stderr);
}

int bench(const GlobalOptions& global, const BenchOptions& o) {
  const Experiment experiment = openExperiment(o.experiment);
  for (const std::string& w : experiment.warnings) note(w);
  checkOutputFolder("--out", o.out);
  Sweep sweep(experiment, o.out);
  const auto progress = interruptibleProgress(global);
  Session session(global.session());
  session.useProgress(progress);
  sayRebuilds(global, session);
  if (!global.json) sweep.onStatus = showStatus;
  try {
    sweep.run(session, *progress);
  } catch (const Error& e) {
    finishProgress();
    if (e.kind() != ErrorKind::Cancelled) throw;
    const SweepResults& r = sweep.results();
    throw Error(ErrorKind::Cancelled, fmt::format("cancelled; {} of {} runs are kept in {}: the same command goes on", r.done(), r.plan.size(), o.out));
  }
  finishProgress();
  const std::filesystem::path folder(o.out);
  print(readFile(folder / (global.json ? "results.json" : "report.md")));
  const size_t failed = sweep.results().failed();
  const int code = validationVerdict(global, session.device(), 0);
  if (failed)
    throw Error(sweep.results().failedByInput() ? ErrorKind::BadInput : ErrorKind::Run,
                fmt::format("{} of {} runs failed, the first: {} (results.csv has each)", failed, sweep.results().plan.size(), sweep.results().firstFailed()->failed));
  return code;
}

}  // namespace hl::cli
