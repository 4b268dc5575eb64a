#pragma once
// A sweep: an experiment's runs, made through one Session, kept in a folder one file a run, and taken up again where it was left.
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "engine/experiment/experiment.h"
#include "engine/session/session.h"
#include "engine/sweep/run_record.h"

namespace hl {

/// The path tracer after some paths a pixel.
struct TracerPoint {
  uint32_t paths = 0;   ///< a pixel
  double ms = 0;        ///< that they took
  std::vector<ErrorValue> errors;
};
/// The reference's path tracer as a competitor, on the host, along the paths that a technique models, from a seed of its own.
struct TracerRun {
  std::string key;
  size_t problem = 0;
  std::string transport;
  uint32_t seed = 1;
  unsigned threads = 1;
  /// At growing times; among them the last before each of the times that configurations took.
  std::vector<TracerPoint> points;
};

/// Configurations whose errors can be compared: the same scene, lights, camera, resolution and reference.
struct SweepProblem {
  std::string label;  ///< "cornell_box, front, 160x120"
  std::vector<size_t> configurations;
};

/// Everything a sweep has found so far. Complete in itself: summarise() makes tables of it.
struct SweepResults {
  Experiment experiment;
  std::vector<Configuration> configurations;
  std::vector<size_t> counterparts;  ///< by configuration: the one that it is compared with, or itself
  std::vector<SweepProblem> problems;
  std::vector<PlannedRun> plan;
  std::vector<std::optional<RunRecord>> runs;  ///< by position in the plan; without a value where not yet run
  std::vector<TracerRun> tracer;
  Provenance provenance;      ///< of the session that made or took up the runs
  bool cpuDevice = true;
  unsigned hostThreads = 1;
  double copyGbps = 0;        ///< [GB/s] that the device copies, each byte read and written: measured once as the sweep begins; 0: not yet
  std::filesystem::path folder;

  size_t done() const;
  size_t failed() const;
  /// The first run that failed; null: none. And whether the experiment is at fault in all that did.
  const RunRecord* firstFailed() const;
  bool failedByInput() const;
  bool complete() const { return done() == plan.size(); }
};

struct SweepStatus {
  std::string doing;        ///< "radiosity.samples 64, seed 2"
  size_t done = 0, total = 0, failed = 0;
  double secondsLeft = -1;  ///< from what runs have taken so far; unknown before the first
};

/// Not tied to a thread: whoever calls run() lends it one, with the Session. Prints nothing.
class Sweep {
 public:
  /// Takes up what the folder holds already. Touches no device. @throws Error(BadInput) for an experiment that makes too many runs.
  Sweep(const Experiment&, std::filesystem::path folder);

  /// Called on the thread that runs: before each step, and after each run with its place in the plan.
  std::function<void(const SweepStatus&)> onStatus;
  std::function<void(const SweepResults&, size_t run)> onRun;

  /// Makes what is missing, then the path tracer's runs, then the tables. A run that fails is recorded, and the others go on. Runs that failed in an
  /// earlier call are tried again, those that took too long are not. Leaves the session with the last configuration loaded.
  /// @throws Error(BadInput) where the folder holds runs of another commit, device or tracer: they are not to be compared. Error(Cancelled) once what
  /// was done is written, tables included. Error(Device) where the device was lost.
  void run(Session&, Progress&);

  const SweepResults& results() const { return results_; }

 private:
  void takeUp();
  void takeProvenance();
  void checkSameMachine(const Session&) const;
  void report(const std::string& doing);
  double secondsLeft() const;
  void traceReferences(Session&, Progress&);
  void warmUp(Session&, Progress&);
  void runAll(Session&, Progress&);
  void raceTracer(Session&, Progress&);
  void store(const RunRecord&, const RunResults&, const Preset&) const;

  SweepResults results_;
};

/// Reads a folder that a sweep has written (experiment.json, runs/, path_tracer/). @throws Error(BadInput)
SweepResults openSweep(const std::filesystem::path& folder);

/// One run, measured; with the session's reference, which is traced first where it is missing. The images that bias and variance need are written to
/// `variancePicture` unless that is empty, the picture (EXR) to `picture` likewise. `comparedWith`: the same of the run that it is compared with; empty where
/// there is none, and a failure of this run where it is missing. @throws Error(Cancelled, Device); other failures are in the record.
RunRecord measureRun(Session&, const Experiment&, const PlannedRun&, const std::filesystem::path& variancePicture, const std::filesystem::path& picture,
                     Progress&, RunResults& results, const std::filesystem::path& comparedWith = {});

/// The same for presets that are measured against the same references: their problem, and the technique, whose light paths the matched one follows.
std::string referenceProblem(const Preset&);
/// Problems of an experiment's configurations.
std::vector<SweepProblem> problemsOf(const std::vector<Configuration>&);
/// Those that the folder holds for the runs as they are.
std::vector<TracerRun> storedTracerRuns(const SweepResults&);
std::string tracerRunJson(const TracerRun&);
TracerRun readTracerRun(const std::string& text, const std::string& whereFrom);
/// Where bias and variance, and runs that are compared with it, find the picture of a run; PFM, indirect irradiance.
std::filesystem::path variancePictureOf(const std::filesystem::path& folder, const PlannedRun&);
bool wantsVariance(const Experiment&, const PlannedRun&);
/// Whether it is kept: for these, or since others are compared with it.
bool keepsPicture(const SweepResults&, const PlannedRun&);

}  // namespace hl
