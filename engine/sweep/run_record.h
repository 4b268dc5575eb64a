#pragma once
// One run of a sweep: what is measured, as it stands in memory and in runs/<key>.json.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/hash.h"
#include "engine/core/json_writer.h"
#include "engine/experiment/experiment.h"
#include "engine/session/results_json.h"

namespace hl {

/// A configuration with a seed, once more for each repeat.
struct PlannedRun {
  size_t configuration = 0;  ///< of configurationsOf()
  uint32_t seed = 1;
  int repeat = 0;
  Preset preset;             ///< with the seed
  std::string key;           ///< of what its numbers depend on, apart from commit and device: the name of its file
};
/// Those that others are compared with first, and for the rest interleaved: all configurations once before the next seed, all seeds before the next repeat, so that a machine that slows down slows all alike.
std::vector<PlannedRun> planOf(const Experiment&, const std::vector<Configuration>&);

/// The metrics that every run measures: those asked for, relmse (for tables) and mse (for bias and variance).
std::vector<std::string> measuredMetrics(const Experiment&);
bool measuresLightmap(const Experiment&);
/// Whether the experiment asks for errors against this reference: its own run's too.
bool wantsReference(const Experiment&, const std::string& reference);
/// What a measurement depends on beside the preset's own hash: metrics, how the picture is shown (some metrics see that) and regions.
void hashMeasurement(Hasher&, const Experiment&, const Preset&);

/// An error as it stood at a moment of a run.
struct ErrorAt {
  uint32_t frames = 0;  ///< since the reset
  double ms = 0;        ///< of preparation, work and frames
  std::vector<ErrorValue> errors;
};

struct RunRecord {
  std::string key;
  uint32_t seed = 1;
  int repeat = 0;
  std::string failed;              ///< why there are no numbers, or ""
  bool badInput = false;           ///< ... and whose fault it is: the experiment's, whose values make no sense together
  bool overLimit = false;          ///< it failed since it took longer than the experiment's limit
  uint32_t frames = 0;             ///< that the picture took
  PassStatistics frameTime;        ///< frames as they are once the work has settled
  double unaccounted = 0;          ///< share of a frame's time that is in no pass
  std::vector<PassStatistics> passes, workPasses;  ///< of a frame; of a unit of work
  std::map<std::string, double> passBytes;         ///< that passes of a frame move, of those that state it
  double copyGbps = 0;             ///< that the device copied when the sweep began, each byte read and written; 0: not measured
  std::map<std::string, double> counters;
  double techniqueMs = 0;          ///< of a frame: the technique's own passes, on average over the frames that were timed
  double prepareMs = 0, workMs = 0;
  double totalMs = 0;              ///< preparation, work and frames up to the picture that was measured
  uint64_t deviceBytes = 0;        ///< all blocks on the device
  uint64_t techniqueBytes = 0;     ///< the technique's own
  uint64_t surfacePixels = 0;
  std::string transport;           ///< the light paths that the technique models, as text: what its competitor traces
  std::string imageHash;
  std::vector<ErrorValue> errors;
  std::vector<ErrorAt> convergence;
  Provenance provenance;
  bool cpuDevice = true;
  unsigned hostThreads = 1;
  double seconds = 0;              ///< that the run took in all, measurement included: for the time left
  std::string json;                ///< the whole document, where it has just been made
};

/// Everything a run published, with `record`'s own figures under "run". RunResults::frame may be null where it failed.
std::string runRecordJson(const RunRecord& record, const RunResults& results, const Preset& preset);
/// @throws Error(BadInput) for a file that is no record.
std::vector<ErrorValue> readErrors(const std::string& json);
RunRecord readRunRecord(const std::string& text, const std::string& whereFrom);

}  // namespace hl
