#include "app/cli_results.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "app/json_writer.h"
#include "engine/experiment/open_target.h"

namespace hl::cli {
namespace {

void writeProvenance(JsonWriter& w, const Provenance& p) {
  w.beginObject()
      .member("commit", p.commit)
      .member("dirty", p.dirty)
      .member("preset_hash", p.presetHash)
      .member("scene_hash", p.sceneHash)
      .member("seed", p.seed)
      .member("device", p.device)
      .member("driver", p.driver)
      .member("api", p.api)
      .member("tracer", p.tracer)
      .member("timing", p.timing)
      .endObject();
}

void writePass(JsonWriter& w, const PassStatistics& p, const char* during) {
  w.beginObject()
      .member("name", p.name)
      .member("where", p.where)
      .member("during", during)
      .member("median_ms", p.medianMs)
      .member("p5_ms", p.p5Ms)
      .member("p95_ms", p.p95Ms)
      .key("skipped");
  p.skipped.empty() ? w.null() : w.text(p.skipped);
  w.endObject();
}

void writeError(JsonWriter& w, const ErrorValue& e) {
  w.beginObject()
      .member("reference", e.reference)
      .member("target", e.target)
      .member("component", e.component)
      .member("metric", e.metric)
      .member("value", e.value)
      .member("noise_floor", e.noiseFloor)
      .member("standard_error", e.standardError)
      .member("non_finite", e.nonFinite)
      .member("roi", e.roi)
      .endObject();
}

void writeStep(JsonWriter& w, const std::pair<std::string, StepReport>& step) {
  const StepReport& s = step.second;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // null
  w.key("step").beginObject().member("edit", step.first).member("size", s.size).member("frames", static_cast<uint64_t>(s.left.size())).member("settled", s.settled);
  w.member("frames_to_5_percent", s.frames5 ? static_cast<double>(*s.frames5) : kNone)
      .member("frames_to_1_percent", s.frames1 ? static_cast<double>(*s.frames1) : kNone)
      .member("ms_to_5_percent", s.ms5.value_or(kNone))
      .member("ms_to_1_percent", s.ms1.value_or(kNone))
      .endObject();
}

std::string stepText(const std::pair<std::string, StepReport>& step) {
  const StepReport& s = step.second;
  const auto reached = [&](const std::optional<uint64_t>& frames, const std::optional<double>& ms, const char* share) {
    return frames ? fmt::format("{} left from frame {} on ({:.2f} s)", share, *frames, *ms / 1000) : fmt::format("{} left not reached in {} frames", share, s.left.size());
  };
  if (s.size == 0) return fmt::format("step {}: it changes nothing in the indirect light\n", step.first);
  return fmt::format("step {}: {}, {}\n", step.first, reached(s.frames5, s.ms5, "5 %"), reached(s.frames1, s.ms1, "1 %"));
}

/// The figure that the convergence plot shows: indirect light of the whole image against the matched reference.
const ErrorValue* plotted(const std::vector<ErrorValue>& errors) {
  for (const ErrorValue& e : errors)
    if (e.reference == "matched" && e.target == "image" && e.component == "indirect" && e.metric == "relmse" &&
        e.roi.empty())
      return &e;
  return nullptr;
}

/// Not a number means that it is not known.
std::string knownText(double v) { return std::isnan(v) ? "n/a" : fmt::format("{:.2g}", v); }

std::string bytesText(uint64_t bytes) { return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20)); }

/// A pass that has nothing to do any more still shows what it took while it had.
std::string passLine(const PassStatistics& p) {
  if (!p.skipped.empty() && !(p.medianMs > 0)) return fmt::format("  {:<40} skipped: {}\n", p.name, p.skipped);
  return fmt::format("  {:<40} {:<4} {:9.3f} {:9.3f} {:9.3f}{}\n", p.name, p.where, p.medianMs, p.p5Ms, p.p95Ms,
                     p.skipped.empty() ? "" : fmt::format("  (now skipped: {})", p.skipped));
}

}  // namespace

std::string provenanceJson(const Provenance& p) {
  JsonWriter w;
  writeProvenance(w, p);
  return w.str();
}

std::map<std::string, std::string> imageAttributes(const Preset& preset, const Provenance& provenance) {
  return {{kPresetAttribute, presetJson(preset)}, {kProvenanceAttribute, provenanceJson(provenance)}};
}

std::string resultsJson(const RunResults& r) {
  const FrameResult& f = *r.frame;
  JsonWriter w;
  w.beginObject()
      .key("preset")
      .raw(presetJson(f.preset, true))
      .member("technique", f.preset.technique)
      .member("frames", f.frame);
  w.member("settled", f.settled).member("cancelled", r.cancelled);
  w.key("frame_ms")
      .beginObject()
      .member("median", f.frameTime.medianMs)
      .member("p5", f.frameTime.p5Ms)
      .member("p95", f.frameTime.p95Ms)
      .member("unaccounted_share", f.unaccounted)
      .endObject();
  w.key("work").beginObject().member("ms", f.workMs).member("units", f.workUnits).endObject();
  w.key("passes").beginArray();
  for (const PassStatistics& p : f.passes) writePass(w, p, "frame");
  for (const PassStatistics& p : f.workPasses) writePass(w, p, "work");
  w.endArray().key("memory").beginArray();
  for (const MemoryItem& m : f.memory) w.beginObject().member("name", m.name).member("bytes", m.bytes).endObject();
  w.endArray().key("errors").beginArray();
  for (const ErrorValue& e : r.errors) writeError(w, e);
  w.endArray().key("counters").beginObject();
  for (const auto& [name, value] : f.counters) w.member(name, value);
  w.endObject().key("convergence").beginArray();
  for (const ConvergencePoint& point : *f.convergence)
    if (const ErrorValue* e = plotted(point.errors))
      w.beginObject().member("frame", point.frame).member("ms", point.ms).member("relmse", e->value).endObject();
  w.endArray().key("image").beginObject();
  w.member("width", f.width)
      .member("height", f.height)
      .member("hash", r.imageHash)
      .member("display_hash", f.displayHash)
      .endObject();
  w.key("files").beginArray();
  for (const std::string& file : r.files) w.text(file);
  w.endArray();
  if (r.step) writeStep(w, *r.step);
  w.member("message", f.message).key("provenance");
  writeProvenance(w, f.provenance);
  return w.endObject().str() + "\n";
}

std::string resultsText(const RunResults& r) {
  const FrameResult& f = *r.frame;
  constexpr double kUnaccountedLimit = 0.1;
  std::string out = fmt::format("{}, {}, {}x{}, {} frames on {}, rays by {}\n", f.preset.scene, f.preset.technique,
                                f.width, f.height, f.frame, f.provenance.device, f.provenance.tracer);
  out += fmt::format("frame {:.2f} ms (p5 {:.2f}, p95 {:.2f}){}\n", f.frameTime.medianMs, f.frameTime.p5Ms,
                     f.frameTime.p95Ms, f.provenance.timing == "serialised" ? ", raster passes timed apart" : "");
  if (f.unaccounted > kUnaccountedLimit) out += fmt::format("{:.0f} % of the frame is in no pass\n", 100 * f.unaccounted);
  if (f.workUnits > 0) out += fmt::format("work {:.2f} s in {} units\n", f.workMs / 1000, f.workUnits);
  out += fmt::format("  {:<40} {:<4} {:>9} {:>9} {:>9}\n", "pass", "", "median ms", "p5", "p95");
  for (const PassStatistics& p : f.passes) out += passLine(p);
  if (!f.workPasses.empty()) out += "of each unit of work\n";
  for (const PassStatistics& p : f.workPasses) out += passLine(p);
  uint64_t device = 0;
  for (const MemoryItem& m : f.memory)
    if (m.name == "device: all blocks") device = m.bytes;
  out += fmt::format("memory {} on the device\n", bytesText(device));
  for (const auto& [name, value] : f.counters) out += fmt::format("  {:<40} {}\n", name, value);
  if (!r.errors.empty())
    out += fmt::format("errors\n  {:<8} {:<8} {:<9} {:<10} {:>12} {:>12} {:>12}\n", "against", "of", "part", "metric",
                       "value", "+-", "noise floor");
  for (const ErrorValue& e : r.errors)
    out += fmt::format("  {:<8} {:<8} {:<9} {:<10} {:12.5g} {:>12} {:>12}{}\n", e.reference, e.target, e.component,
                       e.metric, e.value, knownText(e.standardError), knownText(e.noiseFloor),
                       (e.roi.empty() ? "" : fmt::format("  in {}", e.roi)) +
                           (e.value < e.noiseFloor && e.metric != "psnr" ? "  (less than the reference's noise: more samples tell more)" : ""));
  if (r.step) out += stepText(*r.step);
  if (!r.files.empty()) out += fmt::format("written to {}: {}\n", r.folder, fmt::join(r.files, ", "));
  return out;
}

}  // namespace hl::cli
