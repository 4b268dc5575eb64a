// The tidy tables: one observation a line.
#include <fmt/format.h>

#include <algorithm>

#include "engine/core/csv.h"
#include "engine/sweep/results_folder.h"

namespace hl {
namespace {

/// The keys that any configuration varies.
std::vector<std::string> axes(const SweepResults& r) {
  std::vector<std::string> out;
  for (const Configuration& c : r.configurations)
    for (const auto& [key, value] : c.values)
      if (key != "technique" && std::find(out.begin(), out.end(), key) == out.end()) out.push_back(key);
  return out;
}

std::string axisCells(const SweepResults& r, const std::vector<std::string>& keys, size_t configuration) {
  std::string out;
  for (const std::string& key : keys) {
    std::string value;
    for (const auto& [k, v] : r.configurations[configuration].values)
      if (k == key) value = v;
    out += fmt::format(",{}", csvCell(value));
  }
  return out;
}

std::string errorCells(const ErrorValue& e) {
  return fmt::format(",{},{},{},{},{},{},{},{}", csvCell(e.reference), csvCell(e.target), csvCell(e.component), csvCell(e.metric), csvCell(e.roi), csvCell(e.value),
                     csvCell(e.noiseFloor), csvCell(e.standardError));
}

}  // namespace

std::string sweepCsv(const SweepResults& r) {
  const std::vector<std::string> keys = axes(r);
  std::string out = "kind,problem,configuration,technique";
  for (const std::string& key : keys) out += fmt::format(",{}", csvCell(key));
  out += ",seed,repeat,reference,target,component,metric,roi,value,noise_floor,standard_error,frames,image_hash,device_bytes,technique_bytes,"
         "frame_ms,frame_p5_ms,frame_p95_ms,technique_ms,prepare_ms,work_ms,total_ms,failed,run\n";
  std::vector<size_t> problemAt(r.configurations.size());
  for (size_t p = 0; p < r.problems.size(); ++p)
    for (const size_t c : r.problems[p].configurations) problemAt[c] = p;
  for (size_t i = 0; i < r.plan.size(); ++i) {
    if (!r.runs[i]) continue;
    const PlannedRun& p = r.plan[i];
    const RunRecord& run = *r.runs[i];
    const std::string head = fmt::format("run,{},{},{}{},{},{}", csvCell(r.problems[problemAt[p.configuration]].label), p.configuration,
                                         csvCell(p.preset.technique), axisCells(r, keys, p.configuration), p.seed, p.repeat);
    // How many frames are shown while work goes on is the machine's pace, no result.
    const std::string frames = r.experiment.stop.kind == StopRule::Kind::Settled ? "" : fmt::format("{}", run.frames);
    const std::string tail = fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{}\n", frames, run.imageHash, run.deviceBytes, run.techniqueBytes,
                                         csvCell(run.frameTime.medianMs), csvCell(run.frameTime.p5Ms), csvCell(run.frameTime.p95Ms), csvCell(run.techniqueMs),
                                         csvCell(run.prepareMs), csvCell(run.workMs), csvCell(run.totalMs), csvCell(run.failed), p.key);
    if (!run.failed.empty()) out += head + ",,,,,,,," + tail;
    if (run.failed.empty())
      for (const ErrorValue& e : run.errors)
        if (wantsReference(r.experiment, e.reference)) out += head + errorCells(e) + tail;
  }
  for (const TracerRun& run : r.tracer)
    for (const TracerPoint& point : run.points)
      for (const ErrorValue& e : point.errors)
        if (wantsReference(r.experiment, e.reference))
          out += fmt::format("path_tracer,{},,path_tracer{},{},0{},{},,,,,,,,,,{},,{}\n", csvCell(r.problems[run.problem].label),
                             std::string(keys.size(), ','), run.seed, errorCells(e), point.paths, csvCell(point.ms), run.key);
  return out;
}

std::string convergenceCsv(const SweepResults& r) {
  std::string out = "configuration,technique,seed,repeat,frames,ms,reference,metric,value,noise_floor,standard_error\n";
  for (size_t i = 0; i < r.plan.size(); ++i) {
    if (!r.runs[i] || !r.runs[i]->failed.empty()) continue;
    const PlannedRun& p = r.plan[i];
    for (const ErrorAt& at : r.runs[i]->convergence)
      for (const ErrorValue& e : at.errors)
        if (wantsReference(r.experiment, e.reference))
          out += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", p.configuration, csvCell(p.preset.technique), p.seed, p.repeat, at.frames, csvCell(at.ms),
                             csvCell(e.reference), csvCell(e.metric), csvCell(e.value), csvCell(e.noiseFloor), csvCell(e.standardError));
  }
  return out;
}

}  // namespace hl
