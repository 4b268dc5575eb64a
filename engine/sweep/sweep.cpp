// The order of a sweep, and its folder.
#include "engine/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <new>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/passes/measured_rates.h"
#include "engine/sweep/results_folder.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

// Pipelines are made and shaders compiled at their first use: so much of every technique is run before anything is timed.
constexpr double kWarmUpMs = 2000;

double nowMs() { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// What the reference depends on: the technique's own parameters, the lightmap's and the seed don't matter.
Preset problemOf(Preset p) {
  p.seed = 0;
  p.technique = "none";
  std::erase_if(p.parameters, [](const auto& parameter) { return !parameter.first.starts_with("reference."); });
  return p;
}

std::string problemLabel(const Preset& p) {
  return fmt::format("{}, {}, {}x{}", p.scene, p.camera ? "free camera" : p.cameraName.empty() ? "first camera" : p.cameraName, p.width, p.height);
}

/// What a configuration cannot do shows again in its run, and is recorded there.
template <class F>
void leaveFailuresToTheRun(F&& step) {
  try {
    step();
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::Run && e.kind() != ErrorKind::TooLarge) throw;
  } catch (const std::bad_alloc&) {
  }
}

fs::path recordFile(const fs::path& folder, const std::string& key) { return folder / "runs" / (key + ".json"); }

}  // namespace

std::string referenceProblem(const Preset& preset) { return presetHash(problemOf(preset)) + preset.technique; }

size_t SweepResults::done() const {
  return static_cast<size_t>(std::count_if(runs.begin(), runs.end(), [](const auto& r) { return r.has_value(); }));
}

size_t SweepResults::failed() const {
  return static_cast<size_t>(std::count_if(runs.begin(), runs.end(), [](const auto& r) { return r && !r->failed.empty(); }));
}

const RunRecord* SweepResults::firstFailed() const {
  for (const auto& r : runs)
    if (r && !r->failed.empty()) return &*r;
  return nullptr;
}

bool SweepResults::failedByInput() const {
  return failed() > 0 && std::all_of(runs.begin(), runs.end(), [](const auto& r) { return !r || r->failed.empty() || r->badInput; });
}

std::vector<SweepProblem> problemsOf(const std::vector<Configuration>& configurations) {
  std::vector<SweepProblem> out;
  std::map<std::string, size_t> known;
  for (size_t i = 0; i < configurations.size(); ++i) {
    const Preset problem = problemOf(configurations[i].preset);
    const auto [at, fresh] = known.emplace(presetHash(problem), out.size());
    if (fresh) out.push_back({problemLabel(problem), {}});
    out[at->second].configurations.push_back(i);
  }
  return out;
}

bool wantsVariance(const Experiment& e, const PlannedRun& run) { return e.seeds.size() > 1 && run.repeat == 0; }

bool keepsPicture(const SweepResults& r, const PlannedRun& run) {
  if (wantsVariance(r.experiment, run)) return true;
  bool asked = false;
  for (size_t i = 0; i < r.counterparts.size(); ++i) asked |= i != run.configuration && r.counterparts[i] == run.configuration;
  return asked && run.repeat == 0;  // another repeat is the same picture
}

fs::path variancePictureOf(const fs::path& folder, const PlannedRun& run) { return folder / "runs" / (run.key + ".pfm"); }

Sweep::Sweep(const Experiment& experiment, fs::path folder) {
  SweepResults& r = results_;
  r.experiment = experiment;
  r.folder = std::move(folder);
  r.configurations = configurationsOf(experiment);
  r.counterparts = counterpartsOf(r.experiment, r.configurations);
  r.problems = problemsOf(r.configurations);
  r.plan = planOf(experiment, r.configurations);
  r.runs.resize(r.plan.size());
  takeUp();
}

void Sweep::takeUp() {
  SweepResults& r = results_;
  for (size_t i = 0; i < r.plan.size(); ++i) {
    const PlannedRun& run = r.plan[i];
    const fs::path file = recordFile(r.folder, run.key);
    if (!fs::exists(file)) continue;
    try {
      RunRecord record = readRunRecord(readFile(file), file.string());
      if (record.failed.empty() && keepsPicture(r, run) && !fs::exists(variancePictureOf(r.folder, run))) continue;
      if (record.key == run.key) r.runs[i] = std::move(record);
    } catch (const Error& e) {
      logWarning(fmt::format("{}; it counts as not made", e.what()));
    }
  }
  takeProvenance();
  if (r.experiment.pathTracer) r.tracer = storedTracerRuns(r);
}

/// What all runs have in common.
void Sweep::takeProvenance() {
  SweepResults& r = results_;
  for (const auto& run : r.runs) {
    if (!run) continue;
    r.copyGbps = run->copyGbps;
    r.provenance = run->provenance, r.cpuDevice = run->cpuDevice, r.hostThreads = run->hostThreads;
    r.provenance.presetHash.clear();
    r.provenance.seed = r.experiment.seeds.front();
    return;
  }
}

void Sweep::checkSameMachine(const Session& session) const {
  const Provenance now = session.provenance();
  for (const auto& run : results_.runs) {
    if (!run) continue;
    const Provenance& p = run->provenance;
    const auto differ = [&](const char* what, const std::string& there, const std::string& here) {
      if (there != here)
        throw badInput(fmt::format("{}: holds runs of {} {}, this is {}: one table holds what can be compared; give another folder, or empty this one",
                                   results_.folder.string(), what, there, here));
    };
    differ("commit", p.commit + (p.dirty ? " with changes" : ""), now.commit + (now.dirty ? " with changes" : ""));
    differ("device", p.device, now.device);
    differ("driver", p.driver, now.driver);
    differ("tracer", p.tracer, now.tracer);
    differ("a scene with content", p.sceneHash, now.sceneHash);
    differ("host threads:", std::to_string(run->hostThreads), std::to_string(session.hostThreads()));
  }
}

double Sweep::secondsLeft() const {
  const SweepResults& r = results_;
  std::map<size_t, std::vector<double>> taken;
  double sum = 0, count = 0;
  for (size_t i = 0; i < r.plan.size(); ++i)
    if (r.runs[i]) taken[r.plan[i].configuration].push_back(r.runs[i]->seconds), sum += r.runs[i]->seconds, ++count;
  if (count == 0) return -1;
  double left = 0;
  for (size_t i = 0; i < r.plan.size(); ++i) {
    if (r.runs[i]) continue;
    const auto known = taken.find(r.plan[i].configuration);
    double mean = sum / count;
    if (known != taken.end()) {
      mean = 0;
      for (const double s : known->second) mean += s / static_cast<double>(known->second.size());
    }
    left += mean;
  }
  if (!r.experiment.pathTracer) return left;
  // The path tracer runs as long as a problem's slowest configuration, once a seed.
  for (size_t at = 0; at < r.problems.size(); ++at) {
    const SweepProblem& problem = r.problems[at];
    size_t raced = 0;
    for (const TracerRun& run : r.tracer) raced += run.problem == at ? 1 : 0;
    double slowest = 0;
    for (size_t i = 0; i < r.plan.size(); ++i)
      if (r.runs[i] && std::find(problem.configurations.begin(), problem.configurations.end(), r.plan[i].configuration) != problem.configurations.end())
        slowest = std::max(slowest, r.runs[i]->totalMs / 1000);
    left += slowest * static_cast<double>(r.experiment.seeds.size() - std::min(raced, r.experiment.seeds.size()));
  }
  return left;
}

void Sweep::report(const std::string& doing) {
  if (onStatus) onStatus({doing, results_.done(), results_.plan.size(), results_.failed(), secondsLeft()});
}

void Sweep::store(const RunRecord& record, const RunResults& results, const Preset& preset) const {
  writeFileAtomically(recordFile(results_.folder, record.key), runRecordJson(record, results, preset));
}

/// Each once, from the cache where it is there, so that none is traced between two timed runs.
void Sweep::traceReferences(Session& session, Progress& p) {
  std::set<std::string> traced;
  for (size_t i = 0; i < results_.plan.size(); ++i) {
    if (results_.runs[i]) continue;
    const Preset& preset = results_.plan[i].preset;
    if (!traced.insert(referenceProblem(preset)).second) continue;
    report(fmt::format("reference of {}", problemLabel(preset)));
    session.setReferenceWanted(false);
    session.load(preset, &p);  // bad input ends the sweep here, before the first run
    if (preset.animation.play) continue;  // of where it stops, which its run comes to
    leaveFailuresToTheRun([&] { session.reference("image", &p); });
  }
}

void Sweep::warmUp(Session& session, Progress& p) {
  std::set<std::string> warm;
  for (size_t i = 0; i < results_.plan.size(); ++i) {
    const Preset& preset = results_.plan[i].preset;
    if (results_.runs[i] || !warm.insert(preset.technique).second) continue;
    report(fmt::format("warming up {}", preset.technique));
    session.load(preset, &p);
    const double start = nowMs();
    std::shared_ptr<const FrameResult> f;
    leaveFailuresToTheRun([&] {
      do {
        p.check();
        f = session.frame(&p);
      } while (!f->settled && !f->techniqueFailed && nowMs() - start < kWarmUpMs);
    });
  }
}

void Sweep::runAll(Session& session, Progress& p) {
  SweepResults& r = results_;
  const double copyGbps = r.copyGbps;  // of this call: takeProvenance() may find an earlier one's
  for (size_t i = 0; i < r.plan.size(); ++i) {
    if (r.runs[i]) continue;
    const PlannedRun& run = r.plan[i];
    p.check();
    report(fmt::format("{}, seed {}{}", r.configurations[run.configuration].label(), run.seed,
                       r.experiment.repeats > 1 ? fmt::format(", repeat {}", run.repeat + 1) : ""));
    const bool picture = r.experiment.images && run.repeat == 0 && run.seed == r.experiment.seeds.front();
    RunResults results;
    fs::path other;
    if (const size_t counterpart = r.counterparts[run.configuration]; counterpart != run.configuration)
      for (const PlannedRun& made : r.plan)
        if (made.configuration == counterpart && made.seed == run.seed && made.repeat == 0) other = variancePictureOf(r.folder, made);
    RunRecord record = measureRun(session, r.experiment, run, keepsPicture(r, run) ? variancePictureOf(r.folder, run) : fs::path(),
                                  picture ? pictureOf(r.folder, run.configuration) : fs::path(), p, results, other);
    record.copyGbps = copyGbps;
    store(record, results, run.preset);
    r.runs[i] = std::move(record);
    takeProvenance();
    if (onRun) onRun(r, i);
  }
}

SweepResults openSweep(const fs::path& folder) {
  const fs::path file = folder / "experiment.json";
  if (!fs::exists(file)) throw badInput(fmt::format("{}: no experiment.json here: a folder that `bench` has written is wanted", folder.string()));
  return Sweep(loadExperiment(file), folder).results();
}

void Sweep::run(Session& session, Progress& p) {
  SweepResults& r = results_;
  const fs::path kept = r.folder / "experiment.json";
  if (fs::exists(kept)) {
    try {
      loadExperiment(kept);
    } catch (const Error& e) {
      throw badInput(fmt::format("{}: it would be written over, and is no experiment ({}): another folder is wanted", kept.string(), e.what()));
    }
  }
  std::error_code failed;
  for (const char* part : {"runs", "path_tracer"}) fs::create_directories(r.folder / part, failed);
  if (failed) throw badInput(fmt::format("{}: the folder cannot be made: {}", r.folder.string(), failed.message()));
  r.cpuDevice = session.device().isCpu();
  r.hostThreads = session.hostThreads();
  try {
    for (auto& run : r.runs)
      if (run && !run->failed.empty() && !run->overLimit) run.reset();  // the cause may be mended
    session.load(r.plan.front().preset, &p);
    checkSameMachine(session);
    const bool isItsOwn = fs::exists(kept) && fs::exists(r.experiment.file) && fs::equivalent(kept, r.experiment.file);
    if (!isItsOwn) saveExperiment(r.experiment, kept);
    if (!r.complete()) {
      traceReferences(session, p);
      report("the device's copy rate");
      ShaderLibrary shaders(session.device());
      r.copyGbps = copyRate(session.device(), shaders, p);
      warmUp(session, p);
      runAll(session, p);
    }
    if (r.experiment.pathTracer) raceTracer(session, p);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::Cancelled) throw;
    session.setReferenceWanted(false);
    if (r.done() > 0) writeResultsFolder(r);
    throw;
  }
  report("writing the tables");
  writeResultsFolder(r);
}

}  // namespace hl
