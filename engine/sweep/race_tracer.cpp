// The path tracer at equal time: run progressively, and measured when it has used what each configuration took.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/sweep/sweep.h"
#include "engine/sweep/statistics.h"

namespace hl {
namespace {

namespace fs = std::filesystem;

// Besides at equal times it is measured whenever its paths have grown by this, for its own curve.
constexpr double kLadder = 1.6;

/// Not that of any reference or picture, whose seeds a person chose.
uint64_t tracerSeed(uint32_t seed) {
  Hasher h;
  h.text("path tracer").value(seed);
  return std::stoull(h.hex().substr(0, 15), nullptr, 16);
}

struct Race {
  size_t problem = 0;
  std::string transport;
  Preset preset;              ///< one of the configurations, to load
  std::vector<double> times;  ///< that configurations took, ascending [ms]
};

/// A race for each problem and set of light paths.
std::vector<Race> racesOf(const SweepResults& r) {
  std::vector<Race> out;
  for (size_t problem = 0; problem < r.problems.size(); ++problem)
    for (const size_t c : r.problems[problem].configurations) {
      std::vector<double> times;
      std::string transport;
      for (size_t i = 0; i < r.plan.size(); ++i)
        if (r.plan[i].configuration == c && r.runs[i] && r.runs[i]->failed.empty()) times.push_back(r.runs[i]->totalMs), transport = r.runs[i]->transport;
      if (times.empty() || transport.starts_with("0 bounces")) continue;  // nothing to trace
      auto race = std::find_if(out.begin(), out.end(), [&](const Race& x) { return x.problem == problem && x.transport == transport; });
      if (race == out.end()) race = out.insert(out.end(), {problem, transport, r.configurations[c].preset, {}});
      race->times.push_back(spreadOf(times).median);
    }
  for (Race& race : out) std::sort(race.times.begin(), race.times.end());
  return out;
}

/// Where a scene's time runs, configurations are measured in their last frame: the tracer sees that one, standing.
Preset momentMeasured(Preset preset, const Experiment& e) {
  if (!preset.animation.play) return preset;
  if (e.stop.kind != StopRule::Kind::Frames) throw badInput(fmt::format("{}: a scene whose time runs is raced against the path tracer only with \"stop\" by frames; set \"path_tracer\" to false", e.file.string()));
  preset.animation.play = false;
  preset.animation.start += static_cast<float>(e.stop.amount - 1) / preset.animation.rate;
  return preset;
}

std::string keyOf(const Race& race, uint32_t seed, const Experiment& e) {
  Hasher h;
  h.text(presetHash(race.preset)).text(race.transport).value(seed).array(race.times);
  hashMeasurement(h, e, race.preset);
  return h.hex();
}

void trace(Session& session, const Race& race, const std::vector<std::string>& metrics, TracerRun& out, Progress& p) {
  const auto tracer = session.progressiveTracer(tracerSeed(out.seed));
  double ladder = 1;
  size_t next = 0;
  while (next < race.times.size() || out.points.empty()) {
    p.check();
    tracer->advance(p);
    const double ms = tracer->ms(), pass = ms / tracer->passes();
    // The last pass before a time that is asked for; the first of all where that already took longer.
    bool wanted = false;
    while (next < race.times.size() && ms + pass > race.times[next]) wanted = true, ++next;
    if (tracer->passes() >= ladder) wanted = true, ladder = std::max(ladder + 1, ladder * kLadder);
    if (wanted) out.points.push_back({tracer->passes(), ms, session.measureErrorsOf(tracer->image(), metrics)});
  }
}

fs::path fileOf(const SweepResults& r, const std::string& key) { return r.folder / "path_tracer" / (key + ".json"); }

}  // namespace

std::vector<TracerRun> storedTracerRuns(const SweepResults& r) {
  std::vector<TracerRun> out;
  for (const Race& race : racesOf(r))
    for (const uint32_t seed : r.experiment.seeds) {
      const std::string key = keyOf(race, seed, r.experiment);
      const fs::path file = fileOf(r, key);
      if (!fs::exists(file)) continue;
      try {
        TracerRun run = readTracerRun(readFile(file), file.string());
        if (run.key != key) throw badInput(fmt::format("{}: it holds another race", file.string()));
        run.problem = race.problem;  // problems may have another order by now
        out.push_back(std::move(run));
      } catch (const Error& e) {
        logWarning(fmt::format("{}; it is run again", e.what()));
      }
    }
  return out;
}

void Sweep::raceTracer(Session& session, Progress& p) {
  SweepResults& r = results_;
  const std::vector<std::string> metrics = measuredMetrics(r.experiment);
  r.tracer = storedTracerRuns(r);
  for (const Race& race : racesOf(r)) {
    bool loaded = false;
    for (const uint32_t seed : r.experiment.seeds) {
      TracerRun run{keyOf(race, seed, r.experiment), race.problem, race.transport, seed, r.hostThreads, {}};
      if (std::any_of(r.tracer.begin(), r.tracer.end(), [&](const TracerRun& t) { return t.key == run.key; })) continue;
      if (!loaded) {
        session.load(momentMeasured(race.preset, r.experiment), &p);
        session.reference("image", &p);
        loaded = true;
      }
      report(fmt::format("path tracer at equal time, {}, seed {}", r.problems[race.problem].label, seed));
      trace(session, race, metrics, run, p);
      writeFileAtomically(fileOf(r, run.key), tracerRunJson(run));
      r.tracer.push_back(std::move(run));
    }
  }
}

}  // namespace hl
