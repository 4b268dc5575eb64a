#include "engine/sweep/results_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/files.h"
#include "engine/core/import_module.h"
#include "engine/core/json_writer.h"
#include "engine/sweep/cost_slopes.h"

namespace hl {
namespace {

JsonWriter& write(JsonWriter& w, const char* name, const Estimate& e) {
  return w.key(name).beginObject().member("mean", e.mean).member("ci95", e.halfWidth).member("samples", e.samples).endObject();
}

JsonWriter& write(JsonWriter& w, const char* name, const Spread& s) {
  return w.key(name).beginObject().member("median", s.median).member("p5", s.p5).member("p95", s.p95).endObject();
}

void writeOptional(JsonWriter& w, const std::optional<double>& v) { v ? w.number(*v) : w.null(); }

void writeConfiguration(JsonWriter& w, const SweepResults& r, const ConfigurationSummary& c) {
  const Configuration& conf = r.configurations[c.configuration];
  w.beginObject().member("configuration", c.configuration).member("label", conf.label()).member("problem", c.problem);
  w.key("values").beginObject();
  for (const auto& [key, value] : conf.values) w.member(key, value);
  w.endObject().key("preset").raw(presetJson(conf.preset));
  w.member("runs", c.runs).member("failed", c.failed).member("failure", c.failure).member("frames", c.frames);
  write(w, "frame_ms", c.frameMs), write(w, "technique_ms", c.techniqueMs), write(w, "prepare_ms", c.prepareMs);
  write(w, "work_ms", c.workMs), write(w, "total_ms", c.totalMs);
  w.member("amortised_ms", c.amortisedMs(r.experiment.amortiseFrames)).member("device_bytes", c.deviceBytes).member("technique_bytes", c.techniqueBytes);
  w.key("errors").beginArray();
  for (const ErrorSummary& e : c.errors) {
    w.beginObject().member("reference", e.reference).member("target", e.target).member("component", e.component).member("metric", e.metric);
    w.member("roi", e.roi);
    write(w, "value", e.value).member("noise_floor", e.noiseFloor).member("standard_error", e.standardError).endObject();
  }
  w.endArray().key("bias_variance").beginArray();
  for (const BiasVariance& b : c.parts) {
    w.beginObject().member("reference", b.reference);
    write(w, "bias_squared", b.biasSquared), write(w, "variance", b.variance).endObject();
  }
  w.endArray().key("memory_traffic").beginArray();
  for (const PassSummary& pass : c.passes) {
    if (!(pass.bytes > 0)) continue;
    w.beginObject().member("pass", pass.name).member("bytes_moved", pass.bytes).member("gbps", pass.gbps()).key("share_of_copy");
    r.copyGbps > 0 ? w.number(pass.gbps() / (2 * r.copyGbps)) : w.null();
    w.endObject();
  }
  w.endArray().key("path_tracer_at_equal_time").beginArray();
  for (const EqualTime& e : c.pathTracer) {
    w.beginObject().member("reference", e.reference).member("metric", r.experiment.metrics.front());
    write(w, "value", e.value).member("paths", e.paths).member("ms", e.ms).endObject();
  }
  w.endArray().endObject();
}

const char* placeName(FrontPlace p) { return p == FrontPlace::On ? "on" : p == FrontPlace::Within ? "within" : "off"; }

void writeFront(JsonWriter& w, const Front& f) {
  w.beginObject().member("problem", f.problem).member("axis", kFrontAxes[static_cast<size_t>(f.axis)]).member("reference", f.reference);
  w.member("metric", f.metric).key("points").beginArray();
  for (const FrontPoint& p : f.points)
    w.beginObject().member("configuration", p.configuration).member("cost", p.point.cost).member("error", p.point.error).member("ci95", p.point.halfWidth).member("cost_spread", p.point.costHalfWidth)
        .member("place", placeName(p.place)).endObject();
  w.endArray().endObject();
}

void writeTable(JsonWriter& w, const SpeedTable& t) {
  w.beginObject().member("problem", t.problem).member("competitor", t.competitor).member("reference", t.reference);
  w.member("axis", kFrontAxes[static_cast<size_t>(t.axis)]).key("curve").beginArray();
  for (const CostPoint& p : t.envelope) w.beginObject().member("ms", p.cost).member("relative_error", p.error).endObject();
  w.endArray().key("error_at").beginArray();
  for (const auto& [ms, e] : t.errorAt) w.beginObject().member("ms", ms).key("relative_error"), writeOptional(w, e), w.endObject();
  w.endArray().key("ms_to").beginArray();
  for (const auto& [e, ms] : t.msTo) w.beginObject().member("relative_error", e).key("ms"), writeOptional(w, ms), w.endObject();
  w.endArray().key("least"), writeOptional(w, t.least);
  w.endObject();
}

}  // namespace

std::filesystem::path pictureOf(const std::filesystem::path& folder, size_t configuration) {
  return folder / "images" / fmt::format("configuration_{:04}.{}", configuration, importMissing().empty() ? "exr" : "pfm");
}

std::string sweepJson(const SweepResults& r, const Summary& s) {
  JsonWriter w;
  w.beginObject().member("version", 1).member("complete", r.complete() && r.failed() == 0).member("runs_done", r.done()).member("runs_planned", r.plan.size());
  w.member("runs_failed", r.failed()).member("cpu_device", r.cpuDevice).member("host_threads", r.hostThreads).member("copy_gbps", r.copyGbps);
  w.key("provenance").raw(provenanceJson(r.provenance)).key("experiment").raw(experimentJson(r.experiment));
  w.key("problems").beginArray();
  for (const SweepProblem& p : r.problems) w.text(p.label);
  w.endArray().key("configurations").beginArray();
  for (const ConfigurationSummary& c : s.configurations) writeConfiguration(w, r, c);
  w.endArray().key("fronts").beginArray();
  for (const Front& f : s.fronts) writeFront(w, f);
  w.endArray().key("speed").beginArray();
  for (const SpeedTable& t : s.tables) writeTable(w, t);
  w.endArray().key("cost_slopes").beginArray();
  for (const CostSlope& c : costSlopes(r, s)) {
    w.beginObject().member("problem", c.problem).member("key", c.key).member("fixed", c.fixed).member("quantity", c.quantity).member("cost", c.cost).member("slope", c.slope);
    w.member("standard_error", c.standardError).key("points").beginArray();
    for (const auto& [x, y] : c.points) w.beginObject().member("quantity", x).member("cost", y).endObject();
    w.endArray().endObject();
  }
  w.endArray().key("within_target").beginArray();
  for (const WithinTarget& t : withinTarget(r, s)) {
    w.beginObject().member("problem", t.problem).member("reference", t.reference).member("axis", kFrontAxes[static_cast<size_t>(t.axis)]).key("configuration");
    t.configuration ? w.number(static_cast<double>(*t.configuration)) : w.null();
    w.member("cost", t.cost).member("error", t.error).endObject();
  }
  w.endArray().key("runs").beginArray();
  for (size_t i = 0; i < r.plan.size(); ++i) {
    const PlannedRun& p = r.plan[i];
    w.beginObject().member("key", p.key).member("configuration", p.configuration).member("seed", p.seed).member("repeat", p.repeat);
    w.member("state", !r.runs[i] ? "missing" : r.runs[i]->failed.empty() ? "done" : "failed").member("failed", r.runs[i] ? r.runs[i]->failed : "");
    w.member("file", fmt::format("runs/{}.json", p.key)).endObject();
  }
  return w.endArray().endObject().str() + "\n";
}

void writeResultsFolder(const SweepResults& r) {
  const Summary s = summarise(r);
  writeFileAtomically(r.folder / "results.csv", sweepCsv(r));
  writeFileAtomically(r.folder / "convergence.csv", convergenceCsv(r));
  writeFileAtomically(r.folder / "report.md", sweepReport(r, s));
  writeFileAtomically(r.folder / "results.json", sweepJson(r, s));
}

}  // namespace hl
