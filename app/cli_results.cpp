#include "app/cli_results.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/gpu/timing_limits.h"

namespace hl::cli {
namespace {

std::string stepText(const std::pair<std::string, StepReport>& step) {
  const StepReport& s = step.second;
  const auto reached = [&](const std::optional<uint64_t>& frames, const std::optional<double>& ms, const char* share) {
    return frames ? fmt::format("{} left from frame {} on ({:.2f} s)", share, *frames, *ms / 1000) : fmt::format("{} left not reached in {} frames", share, s.left.size());
  };
  if (s.size == 0) return fmt::format("step {}: it changes nothing in the indirect light\n", step.first);
  const auto ofMean = [](const std::optional<uint64_t>& frames) { return frames ? fmt::format("{}", *frames) : std::string("n/a"); };
  return fmt::format("step {}: {}, {}; {:.2g} at the end, noise {:.2g}; of the mean 5 % from frame {}, 1 % from {}\n", step.first, reached(s.frames5, s.ms5, "5 %"),
                     reached(s.frames1, s.ms1, "1 %"), s.left.back(), s.noise, ofMean(s.meanFrames5), ofMean(s.meanFrames1));
}

/// Not a number means that it is not known.
std::string knownText(double v) { return std::isnan(v) ? "n/a" : fmt::format("{:.2g}", v); }

std::string bytesText(uint64_t bytes) { return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20)); }

/// A pass that has nothing to do any more still shows what it took while it had.
std::string passLine(const PassStatistics& p) {
  if (!p.skipped.empty() && !(p.medianMs > 0)) return fmt::format("  {:<40} skipped: {}\n", p.name, p.skipped);
  if (!(p.medianMs > 0)) return fmt::format("  {:<40} {:<4} not measured\n", p.name, p.where);
  return fmt::format("  {:<40} {:<4} {:9.3f} {:9.3f} {:9.3f}{}\n", p.name, p.where, p.medianMs, p.p5Ms, p.p95Ms,
                     p.share > 0 && p.share < 0.995 ? fmt::format("  (in {:.0f} % of frames)", 100 * p.share) : p.skipped.empty() ? "" : fmt::format("  (now skipped: {})", p.skipped));
}

}  // namespace

std::string resultsText(const RunResults& r) {
  const FrameResult& f = *r.frame;
  std::string out = fmt::format("{}, {}, {}x{}, {} frames on {}, rays by {}\n", f.preset.scene, f.preset.technique,
                                f.width, f.height, f.frame, f.provenance.device, f.provenance.tracer);
  if (!(f.frameTime.medianMs > 0))
    out += "frame not measured: the first is warm-up\n";
  else
    out += fmt::format("frame {:.2f} ms (mean {:.2f}, p5 {:.2f}, p95 {:.2f}){}\n", f.frameTime.medianMs, f.frameTime.meanMs, f.frameTime.p5Ms,
                     f.frameTime.p95Ms, f.provenance.timing == "serialised" ? ", passes timed apart" : "");
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
