// report.md: a sweep for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/gpu/timing_limits.h"
#include "engine/sweep/cost_slopes.h"
#include "engine/sweep/results_folder.h"

namespace hl {
namespace {

const char* const kAxisTitles[] = {"Per frame", "Until settled (preparation, bake and frames)", "Per frame, with the bake spread", "Memory of the technique"};

std::string number(double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : "?"; }
std::string estimate(const Estimate& e) {
  return std::isfinite(e.halfWidth) ? fmt::format("{:.4g} ± {:.2g}", e.mean, e.halfWidth) : number(e.mean);
}
std::string spread(const Spread& s) { return fmt::format("{:.4g} ({:.4g} to {:.4g})", s.median, s.p5, s.p95); }
std::string percent(const std::optional<double>& v) { return v ? fmt::format("{:.3g} %", 100 * *v) : "-"; }
std::string time(double ms) { return ms >= 1000 ? fmt::format("{:.3g} s", ms / 1000) : fmt::format("{:.3g} ms", ms); }
std::string bytes(double v) { return v >= 1 << 20 ? fmt::format("{:.1f} MiB", v / (1 << 20)) : fmt::format("{:.1f} KiB", v / 1024); }
/// In a table's cell a bar would end it.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '|', '/');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string header(const SweepResults& r) {
  const Provenance& p = r.provenance;
  std::string stop = "until settled";
  if (r.experiment.stop.kind == StopRule::Kind::Frames) stop = fmt::format("{} frames after the bake", r.experiment.stop.amount);
  if (r.experiment.stop.kind == StopRule::Kind::Milliseconds) stop = fmt::format("{} ms of work and frames", r.experiment.stop.amount);
  const auto count = [](size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); };
  std::string out = fmt::format("# {}, {}, {}\n\n", count(r.configurations.size(), "configuration"), count(r.experiment.seeds.size(), "seed"), count(static_cast<size_t>(r.experiment.repeats), "repeat"));
  out += fmt::format("{} of {} runs done", r.done() - r.failed(), r.plan.size());
  out += r.failed() ? fmt::format(", **{} failed**.\n\n", r.failed()) : ".\n\n";
  out += fmt::format("- commit {}{}\n- device {}, driver {}, {}, rays by {}, {} timing\n- {} host threads\n- each run: {}\n\n", p.commit,
                     p.dirty ? " with changes that are in no commit" : "", p.device, p.driver, p.api, p.tracer, p.timing, r.hostThreads, stop);
  return out + fmt::format("± is half of a 95 % confidence interval over seeds. Times are medians over the {} runs of a configuration, and their 5th and 95th percentiles; what a front adds to a frame's time is at least the uncertainty of a run's own median. Errors are of indirect irradiance over the whole picture.\n\n", r.experiment.seeds.size() * static_cast<size_t>(r.experiment.repeats));
}

const ErrorSummary* plotted(const ConfigurationSummary& c, const std::string& reference, const std::string& metric) {
  for (const ErrorSummary& e : c.errors)
    if (e.reference == reference && e.metric == metric && e.target == "image" && e.component == "indirect" && e.roi.empty()) return &e;
  return nullptr;
}

std::string configurationTable(const SweepResults& r, const Summary& s, size_t problem) {
  const std::string& metric = r.experiment.metrics.front();
  std::string out = "| configuration | bake ms | frame ms | total ms | memory |", rule = "| --- | --- | --- | --- | --- |";
  for (const std::string& reference : r.experiment.references) {
    out += fmt::format(" {} ({}) | path tracer, same time |", metric, reference);
    rule += " --- | --- |";
  }
  out += "\n" + rule + "\n";
  for (const ConfigurationSummary& c : s.configurations) {
    if (c.problem != problem) continue;
    out += fmt::format("| {} | ", cell(r.configurations[c.configuration].label()));
    if (c.failed == c.runs) {
      out += c.runs ? fmt::format("failed: {} ", cell(c.failure)) : "not run ";
      for (size_t i = 0; i < 3 + 2 * r.experiment.references.size(); ++i) out += "| ";
      out += "|\n";
      continue;
    }
    out += fmt::format("{:.4g} | {} | {} | {} |", c.bakeMs(), spread(c.frameMs), spread(c.totalMs), bytes(c.techniqueBytes));
    for (const std::string& reference : r.experiment.references) {
      const ErrorSummary* e = plotted(c, reference, metric);
      out += e ? fmt::format(" {}{} |", estimate(e->value), metric != "psnr" && std::abs(e->value.mean) < e->noiseFloor ? " (below the reference's noise)" : "")
               : " |";
      std::string tracer = " |";
      for (const EqualTime& t : c.pathTracer)
        if (t.reference == reference)
          tracer = fmt::format(" {} ({:.3g} paths{}) |", estimate(t.value), t.paths, t.ms > 1.05 * c.totalMs.median ? fmt::format(", {}", time(t.ms)) : "");
      out += tracer;
    }
    out += "\n";
  }
  std::string unaccounted;
  for (const ConfigurationSummary& c : s.configurations)
    if (c.problem == problem && c.unaccounted > kUnaccountedLimit)
      unaccounted += fmt::format("{}{} ({:.0f} %)", unaccounted.empty() ? "" : "; ", cell(r.configurations[c.configuration].label()), 100 * c.unaccounted);
  if (!unaccounted.empty())
    out += fmt::format("\nOf these a frame's time is in no pass to more than {:.0f} %, so their passes do not tell the whole: {}.\n", 100 * kUnaccountedLimit,
                       unaccounted);
  return out + "\n";
}

std::string frontTable(const SweepResults& r, const Front& f) {
  const bool memory = f.axis == FrontAxis::Memory;
  std::string title = kAxisTitles[static_cast<size_t>(f.axis)];
  if (f.axis == FrontAxis::Amortised) title += fmt::format(" over {} frames", r.experiment.amortiseFrames);
  std::string out = fmt::format("### {}, against {}\n\n| configuration | cost | {} | |\n| --- | --- | --- | --- |\n", title, f.reference, f.metric);
  size_t off = 0;
  for (const FrontPoint& p : f.points) {
    if (p.place == FrontPlace::Off) {
      ++off;
      continue;
    }
    out += fmt::format("| {} | {} | {} ± {:.2g} | {} |\n", cell(r.configurations[p.configuration].label()), memory ? bytes(p.point.cost) : fmt::format("{} ± {}", time(p.point.cost), time(p.point.costHalfWidth)),
                       number(p.point.error), p.point.halfWidth, p.place == FrontPlace::On ? "on the front" : "within its error bars");
  }
  return out + (off ? fmt::format("\n{} more are dominated.\n\n", off) : "\n");
}

std::string speedTable(const std::vector<const SpeedTable*>& tables) {
  if (tables.empty()) return "";
  std::string out = "| competitor | time |", rule = "| --- | --- |";
  for (const auto& [ms, e] : tables.front()->errorAt) out += fmt::format(" after {} |", time(ms)), rule += " --- |";
  for (const auto& [e, ms] : tables.front()->msTo) out += fmt::format(" to {:g} % |", 100 * e), rule += " --- |";
  out += " levels off at |\n" + rule + " --- |\n";
  for (const SpeedTable* t : tables) {
    out += fmt::format("| {} | {} |", cell(t->competitor), t->axis == FrontAxis::Frame ? "per frame" : "until settled");
    for (const auto& [ms, e] : t->errorAt) out += fmt::format(" {} |", percent(e));
    for (const auto& [e, ms] : t->msTo) out += fmt::format(" {} |", ms ? time(*ms) : "-");
    out += fmt::format(" {} |\n", percent(t->least));
  }
  return out + "\n";
}

std::string partsTable(const SweepResults& r, const Summary& s, size_t problem) {
  std::string rows;
  for (const ConfigurationSummary& c : s.configurations)
    for (const BiasVariance& b : c.parts)
      if (c.problem == problem)
        rows += fmt::format("| {} | {} | {} | {} |\n", cell(r.configurations[c.configuration].label()), b.reference, estimate(b.biasSquared), estimate(b.variance));
  if (rows.empty()) return "";
  std::string out = "### Bias and variance\n\nOf the mean squared error, in its unit.";
  if (r.experiment.seeds.size() < 10) out += fmt::format(" From {} seeds: a claim that rests on these wants at least 10.", r.experiment.seeds.size());
  return out + "\n\n| configuration | against | bias² | variance |\n| --- | --- | --- | --- |\n" + rows + "\n";
}

/// All that was asked for, of picture and lightmap: indirect light, against the matched reference, or the first that was asked for.
std::string errorTable(const SweepResults& r, const Summary& s, size_t problem) {
  if (r.experiment.metrics.size() < 2 && r.experiment.targets == std::vector<std::string>{"image"}) return "";
  const std::string& first = r.experiment.references.front();
  std::string out = fmt::format("### Errors\n\nOf the picture against {}{}.\n\n| configuration |", first,
                                measuresLightmap(r.experiment) ? "; of the lightmap, by area over its valid texels, against matched" : "");
  std::string rule = "\n| --- |", rows;
  for (const std::string& target : r.experiment.targets)
    for (const std::string& metric : r.experiment.metrics) out += fmt::format(" {} {} |", target, metric), rule += " --- |";
  for (const ConfigurationSummary& c : s.configurations) {
    if (c.problem != problem || c.failed == c.runs) continue;
    rows += fmt::format("| {} |", cell(r.configurations[c.configuration].label()));
    for (const std::string& target : r.experiment.targets)
      for (const std::string& metric : r.experiment.metrics) {
        std::string text = " -";
        for (const ErrorSummary& e : c.errors)
          if (e.target == target && e.metric == metric && e.component == "indirect" && e.roi.empty() && e.reference == (target == "lightmap" ? "matched" : first))
            text = fmt::format(" {} ({:.1g})", estimate(e.value), e.standardError);
        rows += text + " |";
      }
    rows += "\n";
  }
  return rows.empty() ? "" : out + rule + "\n" + rows + "\nIn brackets the standard error by the reference's noise.\n\n";
}

/// Against the run that `compare_with` names, whole picture and regions, and beside it against the first reference.
std::string comparisonTable(const SweepResults& r, const Summary& s, size_t problem) {
  if (r.experiment.compareWith.empty()) return "";
  const std::string& beside = r.experiment.references.front();
  const auto find = [](const ConfigurationSummary& c, const std::string& reference, const std::string& metric, const std::string& roi) -> const ErrorSummary* {
    for (const ErrorSummary& e : c.errors)
      if (e.reference == reference && e.target == "image" && e.component == "indirect" && e.metric == metric && e.roi == roi) return &e;
    return nullptr;
  };
  const auto over = [](double value, const ErrorSummary* of) { return of && of->value.mean != 0 ? fmt::format("{:.3g}", value / of->value.mean) : std::string("-"); };
  std::string rows;
  for (const std::string& metric : r.experiment.metrics) {
    std::map<std::pair<size_t, std::string>, const ErrorSummary*> first;  // of those compared with the same run, by region
    for (const ConfigurationSummary& c : s.configurations) {
      const size_t counterpart = r.counterparts[c.configuration];
      if (c.problem != problem || counterpart == c.configuration) continue;
      const ConfigurationSummary* other = nullptr;
      for (const ConfigurationSummary& o : s.configurations)
        if (o.configuration == counterpart) other = &o;
      for (const ErrorSummary& e : c.errors) {
        if (e.reference != kOwnRun || e.metric != metric) continue;
        const ErrorSummary* start = first.emplace(std::pair(counterpart, e.roi), &e).first->second;
        const ErrorSummary* truth = find(c, beside, metric, e.roi);
        rows += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", cell(r.configurations[c.configuration].label()), e.roi.empty() ? "whole picture" : cell(e.roi), metric, estimate(e.value),
                            over(e.value.mean, start), truth ? estimate(truth->value) : "-", truth && other ? over(truth->value.mean, find(*other, beside, metric, e.roi)) : "-");
      }
    }
  }
  if (rows.empty()) return "";
  std::string named;
  for (const auto& [key, value] : r.experiment.compareWith) named += fmt::format("{}{} {}", named.empty() ? "" : ", ", key, value);
  return fmt::format("### Against the run with {}\n\nIndirect irradiance of the picture, seed by seed; beside it against {}. Ratios: to the first configuration of this table, and to that run's own error.\n\n"
                     "| configuration | region | metric | against the run | of the first | against {} | of the run's |\n| --- | --- | --- | --- | --- | --- | --- |\n", named, beside, beside) + rows + "\n";
}

/// What passes move over what they take, beside what the device copies.
std::string trafficTable(const SweepResults& r, const Summary& s, size_t problem) {
  std::string rows;
  for (const ConfigurationSummary& c : s.configurations)
    for (const PassSummary& pass : c.passes)
      if (c.problem == problem && pass.bytes > 0 && pass.ms.median > 0)
        rows += fmt::format("| {} | {} | {} | {:.4g} | {:.4g} | {} |\n", cell(r.configurations[c.configuration].label()), pass.name, bytes(pass.bytes), pass.ms.median, pass.gbps(),
                            r.copyGbps > 0 ? fmt::format("{:.3g} %", 100 * pass.gbps() / (2 * r.copyGbps)) : "-");
  if (rows.empty()) return "";
  return fmt::format("### Memory traffic\n\nBytes that a pass has to read and write, each once, over its time; beside it the share of what a copy of a large buffer moves here ({:.4g} GB/s read and as much written). "
                     "Above 100 % the matrices were still in a cache.\n\n| configuration | pass | moves | ms | GB/s | share of copy |\n| --- | --- | --- | --- | --- | --- |\n",
                     r.copyGbps) + rows + "\n";
}

std::string slopeTable(const SweepResults& r, const Summary& s, size_t problem) {
  std::string rows;
  for (const CostSlope& c : costSlopes(r, s)) {
    if (c.problem != problem) continue;
    const auto& [x0, y0] = c.points.front();
    const auto& [x1, y1] = c.points.back();
    rows += fmt::format("| {} | {} | {} | {:.4g} to {:.4g} | {:.4g} to {:.4g} | {:.3g} ± {:.2g} |\n", c.cost, c.quantity, c.fixed.empty() ? "-" : cell(c.fixed), x0, x1, y0, y1, c.slope, c.standardError);
  }
  if (rows.empty()) return "";
  return "### How cost grows\n\nSlopes of straight lines in both logarithms, by least squares, with their standard error: 1 is proportional. A technique's passes of a frame, its preparation and work, its memory.\n\n"
         "| cost | over | with | from, to | cost from, to | slope |\n| --- | --- | --- | --- | --- | --- |\n" + rows + "\n";
}

std::string targetTable(const SweepResults& r, const Summary& s, size_t problem) {
  std::string rows;
  for (const WithinTarget& t : withinTarget(r, s)) {
    if (t.problem != problem) continue;
    const bool memory = t.axis == FrontAxis::Memory;
    rows += fmt::format("| {} | {} | ", kFrontAxes[static_cast<size_t>(t.axis)], t.reference);
    rows += t.configuration ? fmt::format("{} | {} | {:.4g} |\n", cell(r.configurations[*t.configuration].label()), memory ? bytes(t.cost) : time(t.cost), t.error) : "none of these | | |\n";
  }
  if (rows.empty()) return "";
  return fmt::format("### Cheapest with {} at most {:.4g}\n\n| least | against | configuration | cost | error |\n| --- | --- | --- | --- | --- |\n", r.experiment.metrics.front(), r.experiment.targetError) +
         rows + "\n";
}

}  // namespace

std::string sweepReport(const SweepResults& r, const Summary& s) {
  std::string out = header(r);
  for (size_t problem = 0; problem < r.problems.size(); ++problem) {
    out += fmt::format("## {}\n\n", r.problems[problem].label) + configurationTable(r, s, problem);
    out += targetTable(r, s, problem) + errorTable(r, s, problem) + comparisonTable(r, s, problem) + trafficTable(r, s, problem) + slopeTable(r, s, problem);
    for (const std::string& reference : r.experiment.references) {
      out += fmt::format("### Speed against relative error (root of relmse), against {}\n\n", reference);
      std::vector<const SpeedTable*> tables;
      for (const SpeedTable& t : s.tables)
        if (t.problem == problem && t.reference == reference) tables.push_back(&t);
      out += speedTable(tables);
    }
    for (const Front& f : s.fronts)  // those against the other reference are in results.json
      if (f.problem == problem && f.reference == r.experiment.references.front() && !f.points.empty()) out += frontTable(r, f);
    out += partsTable(r, s, problem);
  }
  return out;
}

}  // namespace hl
