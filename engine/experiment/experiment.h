#pragma once
// An experiment: a preset, what is varied about it, and how it is measured (DESIGN.md section 9). README.md beside this file describes the file.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "engine/experiment/preset.h"

namespace hl {

inline constexpr int kExperimentVersion = 1;
/// More runs than this are a slip of the pen: at a second each they would take three hours.
inline constexpr uint64_t kMaxRuns = 10'000;
inline constexpr int kMaxAxisValues = 1000;

/// What is varied about the base's time: where it starts [s].
inline constexpr const char* kStartAxis = "animation.start";

/// What is varied: a dotted parameter key, "technique", "camera", "resolution" ("640x360") or kStartAxis; and its values as text.
struct PermuteAxis {
  std::string key;
  std::vector<std::string> values;
};
/// All combinations of the axes' values. The first axis varies slowest. An axis of a technique's own parameter applies to the configurations with that
/// technique alone and leaves the others single.
using Permutation = std::vector<PermuteAxis>;

/// What errors against a run of the experiment's own are called, where references are "matched" and "full".
inline constexpr const char* kOwnRun = "run";

struct StopRule {
  enum class Kind { Settled, Frames, Milliseconds };
  Kind kind = Kind::Settled;
  double amount = 0;  ///< frames, or milliseconds of preparation, work and frames
  bool operator==(const StopRule&) const = default;
};

struct Experiment {
  Preset base;
  std::vector<Permutation> permute;  ///< their union; empty: the base alone
  std::vector<uint32_t> seeds = {1};
  std::vector<std::string> metrics = {"relmse"};  ///< the first is that of the fronts
  std::vector<std::string> references = {"matched", "full"};
  std::vector<std::string> targets = {"image"};   ///< errors of what: "image", "lightmap" (of techniques that have one; matched alone)
  /// One of its own configurations that every other is compared with besides: the one that differs from it in these values alone (kOwnRun). Empty: none.
  std::vector<std::pair<std::string, std::string>> compareWith;
  double targetError = 0;      ///< of the first metric: the report names the cheapest configurations that stay within it; 0: none
  StopRule stop;
  double limitMs = 0;          ///< of preparation, work and frames: a run that takes longer is ended, and recorded as failed; 0: none
  int repeats = 1;             ///< of every configuration and seed: errors are the same, times are not
  int amortiseFrames = 60;     ///< over which the bake is spread in one of the fronts: light that changes once a second
  bool pathTracer = true;      ///< the path tracer at equal time is among the competitors
  bool images = false;         ///< an EXR of each configuration
  std::filesystem::path file;  ///< where it came from, not part of its identity
  std::vector<std::string> warnings;
};

/// One way to set the knobs: the base with the values of one combination. Its seed is the base's.
struct Configuration {
  Preset preset;
  std::vector<std::pair<std::string, std::string>> values;  ///< what was varied, in the order of the axes
  std::string label() const;                                ///< "radiosity.samples 64, lightmap.resolution 128", or the technique
};

/// Without those that come to the same (values rounded to one, an axis that a technique does not have).
/// @throws Error(BadInput) where there would be more than kMaxRuns runs.
std::vector<Configuration> configurationsOf(const Experiment&);

/// Of each the place of the configuration that it is compared with (Experiment::compareWith); its own where there is none, or it is that one itself.
/// @throws Error(BadInput) naming a configuration that has no such counterpart.
std::vector<size_t> counterpartsOf(const Experiment&, const std::vector<Configuration>&);

/// @throws Error(BadInput): file, JSON path, value, what would be right.
Experiment loadExperiment(const std::filesystem::path&);
/// `file` is what relative paths are relative to; it need not exist.
Experiment experimentFromJson(const std::string& text, const std::filesystem::path& file);
/// With the base in place and all values listed: what it says does not depend on other files.
std::string experimentJson(const Experiment&);
void saveExperiment(const Experiment&, const std::filesystem::path&);
/// Its JSON Schema; `presets`: the JSON pointer of that of presets, as "#/$defs/preset".
std::string experimentSchema(const std::string& presets);

/// Those in presets/experiments/.
std::vector<PresetListing> listExperiments();
/// A file, a bundle of one, or the name of one of those. @throws Error(BadInput)
Experiment openExperiment(const std::string& nameOrPath);
/// Whether openExperiment() is what opens it: a file with a "base", a bundle of an experiment, or a shipped one's name that is no preset's. False where it cannot
/// be read.
bool isExperiment(const std::string& nameOrPath);

/// Gives the preset another technique; the old one's parameters mean nothing to it and go. @throws Error(BadInput) for an unknown one.
void changeTechnique(Preset&, const std::string& technique);

}  // namespace hl
