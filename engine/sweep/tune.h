#pragma once
// Search of techniques and their knobs for the least error within a time budget, by measured runs (successive halving).
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/sweep/summary.h"
#include "engine/sweep/sweep.h"

namespace hl {

struct TuneOptions {
  Preset base;                          ///< scene, camera, resolution, reference, and one candidate
  double budgetMs = 1000;
  bool perFrame = false;                ///< the budget is for a frame with the bake spread over `amortiseFrames`, not for preparation, bake and frames
  int amortiseFrames = 60;
  std::vector<std::string> techniques;  ///< empty: all but `none`
  std::set<std::string> fixed;          ///< parameter keys that are not varied
  std::string metric = "relmse";
  std::string reference = "full";       ///< what a technique does not model counts as well
  int candidates = 16;                  ///< drawn at first for each technique, its defaults (and the base's values) among them
  uint64_t seed = 1;                    ///< of the drawing
};

/// A candidate as a rung has measured it.
struct Trial {
  Preset preset;
  std::string label;
  double costMs = 0, costP95Ms = 0;  ///< median and 95th percentile over the rung's seeds; of one that was ended, what it had taken
  Estimate error;
  std::string failure;
  bool isDefault = false;            ///< the technique as it comes, or the base as it is
  bool withinBudget = false;
};

struct Rung {
  std::string folder;            ///< a sweep's, within the tuner's
  std::vector<uint32_t> seeds;   ///< that no rung before has seen: what luck chose, it does not confirm
  std::vector<Trial> trials;     ///< best first: within the budget by growing error, then the others by growing cost
};

struct TuneResult {
  std::vector<Rung> rungs;
  const Trial* winner() const;   ///< of the last rung with one within the budget; null where there is none
};

/// The knobs of a technique: its own parameters that change what it computes, and the lightmap's resolution where it has one.
std::vector<const ParamInfo*> knobsOf(const std::string& technique, const std::set<std::string>& fixed);
/// The first candidates: the base's own values, each technique's defaults, and draws from the knobs' soft ranges.
std::vector<Preset> firstCandidates(const TuneOptions&);
/// The next: neighbours of what did best, and draws, of both those that seem to fit the budget by what earlier ones took.
std::vector<Preset> furtherCandidates(const TuneOptions&, const std::vector<Trial>& all, uint64_t round);
/// A neighbour: some knobs moved by up to about a fifth of their soft range (log where they are).
Preset neighbourOf(const Preset&, const TuneOptions&, uint64_t seed);

class Tuner {
 public:
  /// @throws Error(BadInput) for a technique or metric nobody knows, or a budget that is not above 0.
  Tuner(TuneOptions, std::filesystem::path folder);
  std::function<void(const SweepStatus&)> onStatus;

  /// Writes rung_1/, rung_2/ ..., tune.json, tune.md and, where there is a winner, best.json. Taken up where it was left, as sweeps are.
  TuneResult run(Session&, Progress&);

 private:
  Rung measure(Session&, Progress&, const std::vector<Preset>&, const std::string& name, const std::vector<uint32_t>& seeds, bool last);

  TuneOptions options_;
  std::filesystem::path folder_;
};

std::string tuneJson(const TuneOptions&, const TuneResult&);
std::string tuneReport(const TuneOptions&, const TuneResult&);

}  // namespace hl
