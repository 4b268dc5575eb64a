#include "engine/sweep/run_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace hl {
namespace {

// Changes whenever a run of the same preset would be measured in another way: results of before are then not taken up.
constexpr uint32_t kRunVersion = 3;

/// `other`: the preset that it is compared with, null where none.
std::string keyOf(const Experiment& e, const Preset& preset, int repeat, const Preset* other) {
  Hasher h;
  h.value(kRunVersion).text(presetHash(preset)).value(repeat);
  h.value(static_cast<int>(e.stop.kind)).value(e.stop.amount);
  hashMeasurement(h, e, preset);
  if (other) h.text(kOwnRun).text(presetHash(*other));
  return h.hex();
}

using nlohmann::json;

double numberOr(const json& object, const char* key, double otherwise) {
  const auto at = object.find(key);
  return at == object.end() || at->is_null() ? otherwise : at->get<double>();
}

/// null is NaN: a value that JSON could not hold.
double value(const json& object, const char* key) { return numberOr(object, key, std::numeric_limits<double>::quiet_NaN()); }

std::vector<ErrorValue> errorsOf(const json& list) {
  std::vector<ErrorValue> out;
  for (const json& e : list) {
    ErrorValue v;
    v.reference = e.at("reference"), v.target = e.at("target"), v.component = e.at("component"), v.metric = e.at("metric"), v.roi = e.at("roi");
    v.value = value(e, "value"), v.noiseFloor = value(e, "noise_floor"), v.standardError = value(e, "standard_error");
    v.nonFinite = e.at("non_finite").get<uint64_t>();
    out.push_back(std::move(v));
  }
  return out;
}

void writeErrors(JsonWriter& w, const std::vector<ErrorValue>& errors) {
  w.beginArray();
  for (const ErrorValue& e : errors) writeError(w, e);
  w.endArray();
}

PassStatistics passOf(const json& p) {
  PassStatistics out;
  out.name = p.at("name"), out.where = p.at("where");
  out.medianMs = numberOr(p, "median_ms", 0), out.p5Ms = numberOr(p, "p5_ms", 0), out.p95Ms = numberOr(p, "p95_ms", 0);
  out.meanMs = numberOr(p, "mean_ms", 0), out.share = numberOr(p, "share_of_frames", 1), out.frameMs = numberOr(p, "frame_ms", out.medianMs);
  if (!p.at("skipped").is_null()) out.skipped = p.at("skipped");
  return out;
}

}  // namespace

void hashMeasurement(Hasher& h, const Experiment& e, const Preset& preset) {
  for (const std::string& m : measuredMetrics(e)) h.text(m);
  if (measuresLightmap(e)) h.text("lightmap");
  h.value(preset.display.exposure).value(static_cast<int>(preset.display.toneMap));
  h.value(preset.regions.has_value());
  if (preset.regions)
    for (const Region& r : *preset.regions) h.text(r.name).value(r.x).value(r.y).value(r.width).value(r.height);
}

bool wantsReference(const Experiment& e, const std::string& reference) {
  return reference == kOwnRun ? !e.compareWith.empty() : std::find(e.references.begin(), e.references.end(), reference) != e.references.end();
}

bool measuresLightmap(const Experiment& e) { return std::find(e.targets.begin(), e.targets.end(), "lightmap") != e.targets.end(); }

std::vector<std::string> measuredMetrics(const Experiment& e) {
  std::vector<std::string> out = e.metrics;
  for (const char* always : {"relmse", "mse"})
    if (std::find(out.begin(), out.end(), always) == out.end()) out.emplace_back(always);
  return out;
}

std::vector<PlannedRun> planOf(const Experiment& e, const std::vector<Configuration>& configurations) {
  const std::vector<size_t> counterparts = counterpartsOf(e, configurations);
  // Those that others are compared with come first: their pictures must be there.
  std::vector<size_t> order;
  for (const bool first : {true, false})
    for (size_t i = 0; i < configurations.size(); ++i) {
      bool asked = false;
      for (size_t j = 0; j < counterparts.size(); ++j) asked |= j != i && counterparts[j] == i;
      if (asked == first) order.push_back(i);
    }
  std::vector<PlannedRun> out;
  for (int repeat = 0; repeat < e.repeats; ++repeat)
    for (const uint32_t seed : e.seeds)
      for (const size_t i : order) {
        PlannedRun run{i, seed, repeat, configurations[i].preset, ""};
        run.preset.seed = seed;
        Preset other = configurations[counterparts[i]].preset;
        other.seed = seed;
        run.key = keyOf(e, run.preset, repeat, counterparts[i] == i ? nullptr : &other);
        out.push_back(std::move(run));
      }
  return out;
}

std::string runRecordJson(const RunRecord& r, const RunResults& results, const Preset& preset) {
  JsonWriter w;
  w.beginObject();
  w.key("run").beginObject().member("key", r.key).member("seed", r.seed).member("repeat", r.repeat).key("failed");
  r.failed.empty() ? w.null() : w.text(r.failed);
  w.member("bad_input", r.badInput).member("over_limit", r.overLimit).member("technique_ms", r.techniqueMs).member("total_ms", r.totalMs).member("device_bytes", r.deviceBytes);
  w.member("technique_bytes", r.techniqueBytes).member("surface_pixels", r.surfacePixels).member("frames", r.frames);
  w.member("seconds", r.seconds).member("transport", r.transport).member("cpu_device", r.cpuDevice).member("host_threads", r.hostThreads).member("copy_gbps", r.copyGbps).key("errors_at").beginArray();
  for (const ErrorAt& at : r.convergence) {
    w.beginObject().member("frames", at.frames).member("ms", at.ms).key("errors");
    writeErrors(w, at.errors);
    w.endObject();
  }
  w.endArray().endObject();
  if (results.frame) {
    writeResultMembers(w, results);
  } else {
    w.key("preset").raw(presetJson(preset, true)).member("technique", preset.technique).key("errors").beginArray().endArray();
    w.key("provenance").raw(provenanceJson(r.provenance));
  }
  return w.endObject().str() + "\n";
}

std::vector<ErrorValue> readErrors(const std::string& text) { return errorsOf(json::parse(text)); }

RunRecord readRunRecord(const std::string& text, const std::string& whereFrom) {
  try {
    const json d = json::parse(text);
    const json& run = d.at("run");
    RunRecord r;
    r.key = run.at("key"), r.seed = run.at("seed"), r.repeat = run.at("repeat");
    if (!run.at("failed").is_null()) r.failed = run.at("failed");
    r.badInput = run.value("bad_input", false), r.overLimit = run.value("over_limit", false);
    r.techniqueMs = value(run, "technique_ms"), r.totalMs = value(run, "total_ms"), r.seconds = value(run, "seconds");
    r.deviceBytes = run.at("device_bytes"), r.techniqueBytes = run.at("technique_bytes"), r.surfacePixels = run.at("surface_pixels");
    r.frames = run.at("frames"), r.transport = run.at("transport");
    r.copyGbps = numberOr(run, "copy_gbps", 0);
    r.cpuDevice = run.at("cpu_device"), r.hostThreads = run.at("host_threads");
    for (const json& at : run.at("errors_at")) r.convergence.push_back({at.at("frames"), value(at, "ms"), errorsOf(at.at("errors"))});
    r.errors = errorsOf(d.at("errors"));
    const json& p = d.at("provenance");
    r.provenance.commit = p.at("commit"), r.provenance.dirty = p.at("dirty"), r.provenance.presetHash = p.at("preset_hash");
    r.provenance.sceneHash = p.at("scene_hash"), r.provenance.seed = p.at("seed"), r.provenance.device = p.at("device");
    r.provenance.driver = p.at("driver"), r.provenance.api = p.at("api"), r.provenance.tracer = p.at("tracer"), r.provenance.timing = p.at("timing");
    if (d.contains("frame_ms")) {
      const json& f = d.at("frame_ms");
      r.frameTime.medianMs = numberOr(f, "median", 0), r.frameTime.p5Ms = numberOr(f, "p5", 0), r.frameTime.p95Ms = numberOr(f, "p95", 0), r.frameTime.meanMs = numberOr(f, "mean", 0);
      r.unaccounted = numberOr(f, "unaccounted_share", 0);
      r.prepareMs = value(d, "prepare_ms"), r.workMs = value(d.at("work"), "ms");
      r.imageHash = d.at("image").at("hash");
      if (d.contains("counters"))
        for (const auto& [name, count] : d.at("counters").items())
          if (count.is_number()) r.counters[name] = count.get<double>();
      for (const json& pass : d.at("passes"))
        if (pass.contains("bytes_moved")) r.passBytes[pass.at("name")] = pass.at("bytes_moved").get<double>();
      for (const json& pass : d.at("passes")) (pass.at("during") == "work" ? r.workPasses : r.passes).push_back(passOf(pass));
    }
    return r;
  } catch (const json::exception& e) {
    throw badInput(fmt::format("{}: no record of a run: {}", whereFrom, e.what()));
  }
}

}  // namespace hl
