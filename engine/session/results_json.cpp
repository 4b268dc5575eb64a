#include "engine/session/results_json.h"

#include <limits>

#include "engine/core/hash.h"
#include "engine/core/json_writer.h"
#include "engine/experiment/open_target.h"
#include "engine/scene/animation.h"

namespace hl {
namespace {

void writeProvenance(JsonWriter& w, const Provenance& p, const std::string& imageHash = "") {
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
      .member("timing", p.timing);
  if (!imageHash.empty()) w.member("image_hash", imageHash);
  w.endObject();
}

/// A time that no frame has given (a pass's first is warm-up) is null: 0 would read as infinitely fast.
double measured(double ms, double medianMs) { return medianMs > 0 ? ms : std::numeric_limits<double>::quiet_NaN(); }

void writePass(JsonWriter& w, const PassStatistics& p, const char* during, const std::vector<MemoryItem>& moved = {}) {
  w.beginObject()
      .member("name", p.name)
      .member("where", p.where)
      .member("during", during)
      .member("median_ms", measured(p.medianMs, p.medianMs))
      .member("p5_ms", measured(p.p5Ms, p.medianMs))
      .member("p95_ms", measured(p.p95Ms, p.medianMs))
      .member("mean_ms", measured(p.meanMs, p.medianMs))
      .member("share_of_frames", p.share)
      .member("frame_ms", measured(p.frameMs, p.medianMs))
      .key("skipped");
  p.skipped.empty() ? w.null() : w.text(p.skipped);
  for (const MemoryItem& m : moved)
    if (m.name == p.name && m.bytes > 0 && p.medianMs > 0) w.member("bytes_moved", m.bytes).member("gbps", static_cast<double>(m.bytes) / (1e6 * p.medianMs));
  w.endObject();
}

void writeStep(JsonWriter& w, const std::pair<std::string, StepReport>& step) {
  const StepReport& s = step.second;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // null
  w.key("step").beginObject().member("edit", step.first).member("size", s.size).member("frames", static_cast<uint64_t>(s.left.size())).member("settled", s.settled);
  w.member("frames_to_5_percent", s.frames5 ? static_cast<double>(*s.frames5) : kNone)
      .member("frames_to_1_percent", s.frames1 ? static_cast<double>(*s.frames1) : kNone)
      .member("ms_to_5_percent", s.ms5.value_or(kNone))
      .member("ms_to_1_percent", s.ms1.value_or(kNone))
      .member("left_at_end", s.left.empty() ? kNone : s.left.back())
      .member("noise", s.noise)
      .member("frames_to_5_percent_of_mean", s.meanFrames5 ? static_cast<double>(*s.meanFrames5) : kNone)
      .member("frames_to_1_percent_of_mean", s.meanFrames1 ? static_cast<double>(*s.meanFrames1) : kNone);
  w.key("left").beginArray();
  for (const double left : s.left) w.number(left);
  w.endArray().key("left_of_mean").beginArray();
  for (const double left : s.meanLeft) w.number(left);
  w.endArray().endObject();
}

/// The figure that the convergence plot shows: indirect light of the whole image against the matched reference.
const ErrorValue* plotted(const std::vector<ErrorValue>& errors) {
  for (const ErrorValue& e : errors)
    if (e.reference == "matched" && e.target == "image" && e.component == "indirect" && e.metric == "relmse" &&
        e.roi.empty())
      return &e;
  return nullptr;
}

}  // namespace

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

std::string provenanceJson(const Provenance& p, const std::string& imageHash) {
  JsonWriter w;
  writeProvenance(w, p, imageHash);
  return w.str();
}

std::map<std::string, std::string> imageAttributes(const Preset& preset, const Provenance& provenance) {
  return {{kPresetAttribute, presetJson(preset)}, {kProvenanceAttribute, provenanceJson(provenance)}};
}

std::string hashOfImage(const Image& image) {
  return hashOf({reinterpret_cast<const char*>(image.data.data()), image.data.size() * sizeof(float)});
}

void writeResultMembers(JsonWriter& w, const RunResults& r) {
  const FrameResult& f = *r.frame;
  w.key("preset")
      .raw(presetJson(f.preset, true))
      .member("technique", f.preset.technique)
      .member("frames", f.frame);
  w.member("settled", f.settled).member("cancelled", r.cancelled);
  if (animated(*f.scene) || !f.preset.animation.cameraPath.empty()) w.member("time_s", f.time);
  w.key("frame_ms")
      .beginObject()
      .member("median", measured(f.frameTime.medianMs, f.frameTime.medianMs))
      .member("p5", measured(f.frameTime.p5Ms, f.frameTime.medianMs))
      .member("p95", measured(f.frameTime.p95Ms, f.frameTime.medianMs))
      .member("mean", measured(f.frameTime.meanMs, f.frameTime.medianMs))
      .member("unaccounted_share", f.unaccounted)
      .endObject();
  w.member("prepare_ms", f.prepareMs);
  w.key("work").beginObject().member("ms", f.workMs).member("units", f.workUnits).endObject();
  w.key("settled_after").beginObject().member("frames", f.settledFrames).member("ms", f.settledMs).endObject();
  w.key("passes").beginArray();
  for (const PassStatistics& p : f.passes) writePass(w, p, "frame", f.bytesMoved);
  for (const PassStatistics& p : f.workPasses) writePass(w, p, "work");
  w.endArray().key("memory").beginArray();
  for (const MemoryItem& m : f.memory) w.beginObject().member("name", m.name).member("bytes", m.bytes).endObject();
  w.endArray().key("errors").beginArray();
  for (const ErrorValue& e : r.errors) writeError(w, e);
  w.endArray().key("counters").beginObject();
  for (const auto& [name, value] : f.counters) w.member(name, value);
  w.endObject();
  if (f.probes) {
    const PlacedProbes& p = *f.probes;
    w.key("probes").beginObject();
    w.member("count", static_cast<uint64_t>(p.count())).member("coverage", p.coverage).member("seconds", p.seconds).member("candidates", p.candidates);
    w.member("rejected_inside", p.rejectedInside).member("rejected_near", p.rejectedNear).member("moved", p.moved).member("merged", p.merged);
    w.member("inside_geometry", p.insideGeometry).endObject();
  }
  w.key("convergence").beginArray();
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
}

std::string resultsJson(const RunResults& r) {
  JsonWriter w;
  w.beginObject();
  writeResultMembers(w, r);
  return w.endObject().str() + "\n";
}

}  // namespace hl
