#include "engine/sweep/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <tuple>

#include "engine/core/error.h"
#include "engine/core/image_io.h"
#include "engine/core/log.h"

namespace hl {
namespace {

// Of the tables of speed against error (MEASURES.md section 4).
constexpr double kCpuTimesMs[] = {100, 300, 1000, 3000, 10000}, kGpuTimesMs[] = {1, 3, 10, 30, 100};
constexpr double kRelativeErrors[] = {0.1, 0.05, 0.02, 0.01};
constexpr double kNormal95 = 1.96;

bool isPlotted(const ErrorValue& e, const std::string& reference, const std::string& metric) {
  return e.reference == reference && e.metric == metric && e.target == "image" && e.component == "indirect" && e.roi.empty();
}

/// Per error: its values by seed (over repeats, their mean).
using ErrorKey = std::tuple<std::string, std::string, std::string, std::string, std::string>;
struct Collected {
  std::map<uint32_t, std::vector<double>> bySeed;
  double noiseFloor = 0, standardError = 0;
  int count = 0;
  size_t order = 0;
};

std::vector<ErrorSummary> errorsOf(const SweepResults& r, const std::vector<size_t>& runs) {
  std::map<ErrorKey, Collected> all;
  for (const size_t i : runs)
    for (const ErrorValue& e : r.runs[i]->errors) {
      if (!wantsReference(r.experiment, e.reference)) continue;
      const size_t order = all.size();
      const auto [at, fresh] = all.emplace(ErrorKey{e.reference, e.target, e.component, e.metric, e.roi}, Collected{});
      Collected& c = at->second;
      if (fresh) c.order = order;
      c.bySeed[r.runs[i]->seed].push_back(e.value);
      c.noiseFloor += e.noiseFloor, c.standardError += e.standardError;
      ++c.count;
    }
  std::vector<std::pair<size_t, ErrorSummary>> sorted;
  for (const auto& [key, c] : all) {
    std::vector<double> seeds;
    for (const auto& [seed, values] : c.bySeed) seeds.push_back(meanOf(values).mean);
    ErrorSummary s;
    std::tie(s.reference, s.target, s.component, s.metric, s.roi) = key;
    s.value = meanOf(seeds);
    s.noiseFloor = c.noiseFloor / c.count, s.standardError = c.standardError / c.count;
    sorted.emplace_back(c.order, std::move(s));
  }
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ErrorSummary> out;
  for (auto& [order, s] : sorted) out.push_back(std::move(s));
  return out;
}

const ErrorSummary* find(const ConfigurationSummary& c, const std::string& reference, const std::string& metric) {
  for (const ErrorSummary& e : c.errors)
    if (e.reference == reference && e.metric == metric && e.target == "image" && e.component == "indirect" && e.roi.empty()) return &e;
  return nullptr;
}

std::vector<BiasVariance> partsOf(const SweepResults& r, const std::vector<size_t>& runs, const ConfigurationSummary& c) {
  std::vector<Image> images;
  std::vector<size_t> used;
  double pixels = 0;
  for (const size_t i : runs) {
    if (!wantsVariance(r.experiment, r.plan[i])) continue;
    const auto file = variancePictureOf(r.folder, r.plan[i]);
    if (!std::filesystem::exists(file)) return {};
    try {
      images.push_back(readImage(file));
    } catch (const Error& e) {
      logWarning(fmt::format("{}; no bias and variance of {}", e.what(), r.configurations[c.configuration].label()));
      return {};
    }
    if (images.back().data.size() != images.front().data.size()) return {};
    used.push_back(i);
    pixels = static_cast<double>(r.runs[i]->surfacePixels);
  }
  std::vector<BiasVariance> out;
  if (images.size() < 2 || !(pixels > 0)) return out;
  for (const std::string& reference : r.experiment.references) {
    std::vector<double> mse;
    double referenceError = 0;
    for (const size_t i : used)
      for (const ErrorValue& e : r.runs[i]->errors)
        if (isPlotted(e, reference, "mse")) mse.push_back(e.value), referenceError += e.standardError / static_cast<double>(used.size());
    if (mse.size() != images.size()) continue;
    out.push_back(biasAndVariance(images, pixels, mse, referenceError));
    out.back().reference = reference;
  }
  return out;
}

/// Of one race by seed: the last point of at most `ms`, else the first.
const TracerPoint* pointAt(const TracerRun& run, double ms) {
  const TracerPoint* best = nullptr;
  for (const TracerPoint& p : run.points)
    if (!best || p.ms <= ms) best = &p;
  return best;
}

std::vector<EqualTime> equalTimes(const SweepResults& r, const ConfigurationSummary& c, const std::string& transport) {
  std::vector<EqualTime> out;
  const std::string& metric = r.experiment.metrics.front();
  for (const std::string& reference : r.experiment.references) {
    EqualTime e;
    e.reference = reference;
    std::vector<double> values;
    for (const TracerRun& run : r.tracer) {
      if (run.problem != c.problem || run.transport != transport) continue;
      const TracerPoint* p = pointAt(run, c.totalMs.median);
      if (!p) continue;
      for (const ErrorValue& v : p->errors)
        if (isPlotted(v, reference, metric)) values.push_back(v.value), e.paths += p->paths, e.ms += p->ms;
    }
    if (values.empty()) continue;
    e.value = meanOf(values);
    e.paths /= static_cast<double>(values.size()), e.ms /= static_cast<double>(values.size());
    out.push_back(std::move(e));
  }
  return out;
}

std::vector<PassSummary> passesOf(const SweepResults& r, const std::vector<size_t>& runs, std::vector<PassStatistics> RunRecord::*kind) {
  std::vector<PassSummary> out;
  std::vector<std::vector<double>> ms;
  for (const size_t i : runs)
    for (const PassStatistics& p : (*r.runs[i]).*kind) {
      if (!p.skipped.empty() && !(p.medianMs > 0)) continue;
      size_t at = 0;
      while (at < out.size() && out[at].name != p.name) ++at;
      if (at == out.size()) out.push_back({p.name, p.where, {}, 0, 1}), ms.emplace_back();
      ms[at].push_back(p.medianMs);
      if (kind == &RunRecord::passes) out[at].share = p.share;
      if (kind == &RunRecord::passes)
        if (const auto moved = r.runs[i]->passBytes.find(p.name); moved != r.runs[i]->passBytes.end()) out[at].bytes = moved->second;
    }
  for (size_t i = 0; i < out.size(); ++i) out[i].ms = spreadOf(ms[i]);
  return out;
}

// Of a median over at least 5 frames: 1.96 * 1.253 sigma / sqrt(5), with sigma a 3.29th of what lies between the 5th and the 95th percentile.
constexpr double kMedianHalfWidth = 0.334;

ConfigurationSummary summaryOf(const SweepResults& r, size_t configuration, size_t problem) {
  ConfigurationSummary c;
  c.configuration = configuration, c.problem = problem;
  std::vector<size_t> good;
  std::vector<double> frame, frameWidth, technique, prepare, work, total;
  std::string transport;
  for (size_t i = 0; i < r.plan.size(); ++i) {
    if (r.plan[i].configuration != configuration || !r.runs[i]) continue;
    const RunRecord& run = *r.runs[i];
    ++c.runs;
    if (!run.failed.empty()) {
      if (c.failed++ == 0) c.failure = run.failed;
      continue;
    }
    good.push_back(i);
    frame.push_back(run.frameTime.meanMs > 0 ? run.frameTime.meanMs : run.frameTime.medianMs), technique.push_back(run.techniqueMs), prepare.push_back(run.prepareMs);
    frameWidth.push_back(kMedianHalfWidth * (run.frameTime.p95Ms - run.frameTime.p5Ms));
    c.unaccounted = std::max(c.unaccounted, run.unaccounted);
    work.push_back(run.workMs), total.push_back(run.totalMs);
    c.frames = run.frames, c.deviceBytes = static_cast<double>(run.deviceBytes), c.techniqueBytes = static_cast<double>(run.techniqueBytes);
    transport = run.transport;
  }
  c.frameMedianMs = spreadOf(frameWidth).median;
  c.frameMs = spreadOf(frame), c.techniqueMs = spreadOf(technique), c.prepareMs = spreadOf(prepare), c.workMs = spreadOf(work), c.totalMs = spreadOf(total);
  if (good.empty()) return c;
  c.passes = passesOf(r, good, &RunRecord::passes), c.workPasses = passesOf(r, good, &RunRecord::workPasses);
  c.errors = errorsOf(r, good);
  c.parts = partsOf(r, good, c);
  c.pathTracer = equalTimes(r, c, transport);
  return c;
}

/// The interval over seeds; of a single seed nothing is known but the reference's noise.
double halfWidthOf(const ErrorSummary& e) { return std::isfinite(e.value.halfWidth) ? e.value.halfWidth : kNormal95 * e.standardError; }

/// relmse to its root.
CostPoint relative(double ms, double relmse, double halfWidth) {
  const double top = relmse + (std::isfinite(halfWidth) ? halfWidth : 0);
  const double error = relmse > 0 ? std::sqrt(relmse) : 0;
  return {ms, error, (top > 0 ? std::sqrt(top) : 0) - error, 0};
}

SpeedTable tableOf(const SweepResults& r, SpeedTable t, const std::vector<CostPoint>& points) {
  t.envelope = lowerEnvelope(points);
  for (const double ms : r.cpuDevice ? kCpuTimesMs : kGpuTimesMs) t.errorAt.emplace_back(ms, errorAtCost(t.envelope, ms));
  for (const double e : kRelativeErrors) t.msTo.emplace_back(e, costOfError(t.envelope, e));
  if (!t.envelope.empty()) t.least = t.envelope.back().error;
  return t;
}

void addTables(const SweepResults& r, Summary& s, size_t problem, const std::string& reference) {
  for (const FrontAxis axis : {FrontAxis::Total, FrontAxis::Frame}) {
    std::map<std::string, std::vector<CostPoint>> byTechnique;
    for (const ConfigurationSummary& c : s.configurations)
      if (const ErrorSummary* e = c.problem == problem ? find(c, reference, "relmse") : nullptr)
        byTechnique[r.configurations[c.configuration].preset.technique].push_back(
            relative(costOf(c, axis, r.experiment.amortiseFrames).median, e->value.mean, halfWidthOf(*e)));
    for (const auto& [technique, points] : byTechnique) s.tables.push_back(tableOf(r, {problem, technique, reference, axis, {}, {}, {}, {}}, points));
  }
  // Its frames are its whole work: there is no time apart for one.
  std::map<std::string, std::map<uint32_t, std::vector<std::pair<double, double>>>> races;
  for (const TracerRun& run : r.tracer)
    for (const TracerPoint& p : run.points)
      if (run.problem == problem)
        for (const ErrorValue& e : p.errors)
          if (isPlotted(e, reference, "relmse"))
            races[fmt::format("path_tracer (host, {} threads; {})", run.threads, run.transport)][p.paths].emplace_back(p.ms, e.value);
  for (const auto& [name, byPaths] : races) {
    std::vector<CostPoint> points;
    for (const auto& [paths, samples] : byPaths) {
      std::vector<double> ms, values;
      for (const auto& [time, value] : samples) ms.push_back(time), values.push_back(value);
      const Estimate e = meanOf(values);
      points.push_back(relative(spreadOf(ms).median, e.mean, e.halfWidth));
    }
    SpeedTable table = tableOf(r, {problem, name, reference, FrontAxis::Total, {}, {}, {}, {}}, points);
    // It was stopped, it did not level off: what it would have come to is not known.
    table.least.reset();
    for (auto& [ms, e] : table.errorAt)
      if (!table.envelope.empty() && ms > table.envelope.back().cost) e.reset();
    s.tables.push_back(std::move(table));
  }
}

}  // namespace

double badness(const std::string& metric, double value) {
  for (const MetricInfo& m : metricInfos()) {
    if (m.id != metric) continue;
    if (std::isinf(m.perfect)) return -value;
    if (m.perfect > 0) return m.perfect - value;
    // Only what is signed by itself counts by its size: a squared error below 0 is a very small one.
    return m.mapSigned ? std::abs(value) : value;
  }
  return value;
}

Spread costOf(const ConfigurationSummary& c, FrontAxis axis, int amortiseFrames) {
  const Spread frame = {c.frameMs.median, std::min(c.frameMs.p5, c.frameMs.median - c.frameMedianMs), std::max(c.frameMs.p95, c.frameMs.median + c.frameMedianMs)};
  switch (axis) {
    case FrontAxis::Frame:
      return frame;
    case FrontAxis::Total:
      return c.totalMs;
    case FrontAxis::Amortised:
      return {c.amortisedMs(amortiseFrames), frame.p5 + (c.prepareMs.p5 + c.workMs.p5) / amortiseFrames, frame.p95 + (c.prepareMs.p95 + c.workMs.p95) / amortiseFrames};
    case FrontAxis::Memory:
      return {c.techniqueBytes, c.techniqueBytes, c.techniqueBytes};
  }
  return {};
}

Front frontOf(const SweepResults& r, const Summary& s, size_t problem, FrontAxis axis, const std::string& reference, const std::string& metric) {
  Front front{problem, axis, reference, metric, {}};
  for (const ConfigurationSummary& c : s.configurations) {
    const ErrorSummary* e = c.problem == problem ? find(c, reference, front.metric) : nullptr;
    if (!e) continue;
    const Spread cost = costOf(c, axis, r.experiment.amortiseFrames);
    front.points.push_back({c.configuration, {cost.median, badness(front.metric, e->value.mean), halfWidthOf(*e), (cost.p95 - cost.p5) / 2}, FrontPlace::On});
  }
  std::stable_sort(front.points.begin(), front.points.end(), [](const FrontPoint& a, const FrontPoint& b) { return a.point.cost < b.point.cost; });
  std::vector<CostPoint> points;
  for (const FrontPoint& p : front.points) points.push_back(p.point);
  const std::vector<FrontPlace> places = paretoFront(points);
  for (size_t i = 0; i < places.size(); ++i) front.points[i].place = places[i];
  return front;
}

Summary summarise(const SweepResults& r) {
  Summary s;
  std::vector<size_t> problemAt(r.configurations.size());
  for (size_t p = 0; p < r.problems.size(); ++p)
    for (const size_t c : r.problems[p].configurations) problemAt[c] = p;
  for (size_t c = 0; c < r.configurations.size(); ++c) s.configurations.push_back(summaryOf(r, c, problemAt[c]));
  for (size_t problem = 0; problem < r.problems.size(); ++problem)
    for (const std::string& reference : r.experiment.references) {
      for (const FrontAxis axis : {FrontAxis::Frame, FrontAxis::Total, FrontAxis::Amortised, FrontAxis::Memory})
        s.fronts.push_back(frontOf(r, s, problem, axis, reference, r.experiment.metrics.front()));
      addTables(r, s, problem, reference);
    }
  return s;
}

}  // namespace hl
