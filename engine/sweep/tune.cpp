// The rungs of the search. README.md says why they are made of seeds and not of smaller pictures.
#include "engine/sweep/tune.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/experiment/open_target.h"
#include "engine/experiment/preset_parameters.h"
#include "engine/techniques/technique.h"

namespace hl {
namespace {

// What is left of a rung for the next, at least; and what a rung's runs may take of the budget before they are ended.
constexpr size_t kKeptOf = 3, kLeastKept = 2;
constexpr double kLimitOfBudget = 1.5;
constexpr double kRoomyShare = 0.6;
// The first rungs look for candidates, one seed each; the last ones judge them.
constexpr int kSeedsOfRungs[] = {1, 1, 1, 3, 6};
constexpr size_t kSearchingRungs = 3;

/// Only what differs between candidates is said about them.
std::string describe(const Preset& p) {
  std::string out = p.technique;
  for (const auto& [key, value] : canonicalParameters(p.technique, p.parameters))
    if (!key.starts_with("reference.")) out += fmt::format(", {} {}", key, value);
  return out;
}

/// As a permutation of one: every knob that it sets, and the technique. What the base sets and the candidate leaves at its default is set to that.
Permutation asPermutation(const Preset& base, const Preset& candidate) {
  Permutation out = {{"technique", {candidate.technique}}};
  const auto groups = parameterGroups(candidate.technique);
  std::map<std::string, std::string> values;
  for (const auto& [key, value] : base.parameters)
    if (const ParamInfo* p = findParameter(groups, key)) values[key] = formatParam(*p, defaultValue(*p));
  for (const auto& [key, value] : candidate.parameters) values[key] = value;
  for (const auto& [key, value] : values)
    if (!base.parameters.count(key) || base.parameters.at(key) != value || base.technique != candidate.technique) out.push_back({key, {value}});
  return out;
}

/// Of the runs that failed: what they took, at least the limit where they were ended.
double slowestRun(const SweepResults& r, size_t configuration, double limitMs) {
  double ms = 0;
  for (size_t i = 0; i < r.plan.size(); ++i)
    if (r.plan[i].configuration == configuration && r.runs[i]) ms = std::max(ms, r.runs[i]->totalMs > 0 ? r.runs[i]->totalMs : 2 * limitMs);
  return ms;
}

bool better(const Trial& a, const Trial& b) {
  if (a.withinBudget != b.withinBudget) return a.withinBudget;
  if (a.withinBudget) return a.error.mean < b.error.mean;
  return a.costMs < b.costMs;
}

}  // namespace

const Trial* TuneResult::winner() const {
  for (auto rung = rungs.rbegin(); rung != rungs.rend(); ++rung)
    if (!rung->trials.empty() && rung->trials.front().withinBudget) return &rung->trials.front();
  return nullptr;
}

Tuner::Tuner(TuneOptions options, std::filesystem::path folder) : options_(std::move(options)), folder_(std::move(folder)) {
  if (!(options_.budgetMs > 0) || !std::isfinite(options_.budgetMs)) throw badInput(fmt::format("a budget above 0 ms is wanted, not {}", options_.budgetMs));
  if (options_.candidates < 2) throw badInput(fmt::format("{} candidates a technique; at least 2 are wanted", options_.candidates));
  for (const std::string& t : options_.techniques) techniqueInfo(t);
  checkMetrics({options_.metric});
  if (options_.reference != "matched" && options_.reference != "full")
    throw badInput(fmt::format("reference {}: matched or full is wanted", options_.reference));
  checkParameters(options_.base);
}

Rung Tuner::measure(Session& session, Progress& p, const std::vector<Preset>& candidates, const std::string& name, const std::vector<uint32_t>& seeds,
                    bool last) {
  Experiment e;
  e.base = options_.base;
  for (const Preset& c : candidates) e.permute.push_back(asPermutation(options_.base, c));
  e.seeds = seeds;
  e.metrics = {options_.metric};
  e.references = {options_.reference};
  e.amortiseFrames = options_.amortiseFrames;
  e.limitMs = kLimitOfBudget * options_.budgetMs * (options_.perFrame ? options_.amortiseFrames : 1);
  e.pathTracer = last;
  e.file = options_.base.file;
  Sweep sweep(e, folder_ / name);
  sweep.onStatus = [&](const SweepStatus& s) {
    SweepStatus named = s;
    named.doing = fmt::format("{}: {}", name, s.doing);
    if (onStatus) onStatus(named);
  };
  sweep.run(session, p);

  const SweepResults& r = sweep.results();
  const Summary summary = summarise(r);
  Rung rung{name, seeds, {}};
  for (const ConfigurationSummary& c : summary.configurations) {
    Trial t;
    t.preset = r.configurations[c.configuration].preset;
    t.label = describe(t.preset);
    t.failure = 2 * c.failed > c.runs ? c.failure : "";  // a seed that was slow once does not end a candidate
    for (const TechniqueInfo& technique : techniqueInfos()) {
      Preset plain = options_.base;
      changeTechnique(plain, std::string(technique.id));
      std::erase_if(plain.parameters, [&](const auto& x) { return x.first.starts_with(std::string(technique.id) + ".") && !options_.fixed.count(x.first); });
      t.isDefault = t.isDefault || presetHash(plain) == presetHash(t.preset);
    }
    t.isDefault = t.isDefault || presetHash(t.preset) == presetHash(options_.base);
    const double bakes = options_.perFrame ? options_.amortiseFrames : 1;
    t.costMs = options_.perFrame ? c.amortisedMs(options_.amortiseFrames) : c.totalMs.median;
    t.costP95Ms = options_.perFrame ? c.frameMs.p95 + (c.prepareMs.p95 + c.workMs.p95) / bakes : c.totalMs.p95;
    if (!t.failure.empty()) t.costMs = t.costP95Ms = slowestRun(r, c.configuration, e.limitMs) / bakes;
    for (const ErrorSummary& x : c.errors)
      if (x.reference == options_.reference && x.metric == options_.metric && x.component == "indirect" && x.target == "image" && x.roi.empty())
        t.error = {badness(options_.metric, x.value.mean), x.value.halfWidth, x.value.samples};
    t.withinBudget = t.failure.empty() && t.costMs <= options_.budgetMs && std::isfinite(t.error.mean) && t.error.samples > 0;
    rung.trials.push_back(std::move(t));
  }
  std::stable_sort(rung.trials.begin(), rung.trials.end(), better);
  return rung;
}

TuneResult Tuner::run(Session& session, Progress& p) {
  TuneResult out;
  std::vector<Preset> candidates = firstCandidates(options_);
  std::vector<Trial> all;
  uint32_t nextSeed = 1;
  const auto write = [&] {
    writeFileAtomically(folder_ / "tune.json", tuneJson(options_, out));
    writeFileAtomically(folder_ / "tune.md", tuneReport(options_, out));
  };
  constexpr size_t kRungs = std::size(kSeedsOfRungs);
  for (size_t rung = 0; rung < kRungs; ++rung) {
    std::vector<uint32_t> seeds;
    for (int i = 0; i < kSeedsOfRungs[rung]; ++i) seeds.push_back(nextSeed++);
    out.rungs.push_back(measure(session, p, candidates, fmt::format("rung_{}", rung + 1), seeds, rung + 1 == kRungs));
    write();
    if (rung + 1 == kRungs) break;
    const std::vector<Trial>& trials = out.rungs.back().trials;
    size_t fitting = 0;
    for (const Trial& t : trials) fitting += t.withinBudget ? 1 : 0;
    all.insert(all.end(), trials.begin(), trials.end());
    const size_t kept = std::min(fitting, std::max(kLeastKept, (trials.size() + kKeptOf - 1) / kKeptOf));
    candidates.clear();
    bool roomy = false;
    for (size_t i = 0; i < trials.size(); ++i) {
      const Trial& t = trials[i];
      const bool room = t.withinBudget && t.costMs <= kRoomyShare * options_.budgetMs;
      // What comes by itself is always compared; and one stays that is within the budget on a slower day, too.
      if (i < kept || (t.isDefault && t.withinBudget) || (room && !roomy)) candidates.push_back(t.preset), roomy |= room;
    }
    if (rung + 1 < kSearchingRungs)
      for (Preset& next : furtherCandidates(options_, all, rung)) candidates.push_back(std::move(next));
    if (candidates.empty()) break;
  }
  if (const Trial* winner = out.winner()) {
    Preset best = winner->preset;
    best.seed = options_.base.seed;
    savePreset(best, folder_ / "best.json");
  }
  return out;
}

}  // namespace hl
