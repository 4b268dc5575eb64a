#include "engine/sweep/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "engine/metrics/metrics.h"

namespace hl {
namespace {

/// From here on the values of an axis lie so far apart that their logarithms are spaced.
constexpr double kLogarithmicRatio = 8;

const ErrorValue* find(const std::vector<ErrorValue>& errors, const std::string& reference, const std::string& metric) {
  for (const ErrorValue& e : errors)
    if (e.reference == reference && e.metric == metric && e.target == "image" && e.component == "indirect" && e.roi.empty()) return &e;
  return nullptr;
}

bool number(const std::string& text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

std::string lastPart(const std::string& key) {
  const size_t dot = key.rfind('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

std::vector<std::string> variedKeys(const SweepResults& r) {
  std::vector<std::string> out;
  for (const Configuration& c : r.configurations)
    for (const auto& [key, value] : c.values)
      if (std::find(out.begin(), out.end(), key) == out.end()) out.push_back(key);
  return out;
}

void placeValues(VariedAxis& axis) {
  std::vector<double> numbers(axis.values.size());
  axis.numeric = true;
  for (size_t i = 0; i < axis.values.size(); ++i) axis.numeric &= number(axis.values[i], numbers[i]);
  axis.places.resize(axis.values.size());
  if (!axis.numeric) {
    for (size_t i = 0; i < axis.places.size(); ++i) axis.places[i] = axis.places.size() == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(axis.places.size() - 1);
    return;
  }
  std::vector<size_t> order(numbers.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return numbers[a] < numbers[b]; });
  std::vector<std::string> values;
  std::vector<double> sorted;
  for (const size_t i : order) values.push_back(axis.values[i]), sorted.push_back(numbers[i]);
  axis.values = std::move(values);
  axis.logarithmic = sorted.front() > 0 && sorted.back() / sorted.front() >= kLogarithmicRatio;
  const auto scaled = [&](double v) { return axis.logarithmic ? std::log(v) : v; };
  const double low = scaled(sorted.front()), high = scaled(sorted.back());
  for (size_t i = 0; i < sorted.size(); ++i) axis.places[i] = high > low ? (scaled(sorted[i]) - low) / (high - low) : 0.5;
}

}  // namespace

std::vector<std::string> plottedMetrics(const SweepResults& r) { return measuredMetrics(r.experiment); }

bool isLogarithmic(const std::string& metric) { return std::isfinite(metricInfo(metric).perfect); }

std::vector<TracerCurve> tracerCurves(const SweepResults& r, size_t problem, const std::string& reference, const std::string& metric) {
  struct Samples {
    std::vector<double> ms, errors;
  };
  std::vector<TracerCurve> out;
  std::vector<std::map<uint32_t, Samples>> samples;
  for (const TracerRun& run : r.tracer) {
    if (run.problem != problem) continue;
    size_t at = 0;
    while (at < out.size() && !(out[at].transport == run.transport && out[at].threads == run.threads)) ++at;
    if (at == out.size()) out.push_back({run.transport, run.threads, {}, {}}), samples.emplace_back();
    for (const TracerPoint& p : run.points)
      if (const ErrorValue* e = find(p.errors, reference, metric)) samples[at][p.paths].ms.push_back(p.ms), samples[at][p.paths].errors.push_back(e->value);
  }
  for (size_t i = 0; i < out.size(); ++i) {
    // Not every seed stopped at the same counts: on a machine whose speed varies more paths can come out sooner.
    std::vector<std::pair<CostPoint, uint32_t>> points;
    for (const auto& [paths, s] : samples[i]) {
      const Estimate e = meanOf(s.errors);
      const Spread ms = spreadOf(s.ms);
      points.push_back({{ms.median, badness(metric, e.mean), std::isfinite(e.halfWidth) ? e.halfWidth : 0, (ms.p95 - ms.p5) / 2}, paths});
    }
    std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first.cost < b.first.cost; });
    for (const auto& [point, paths] : points) out[i].points.push_back(point), out[i].paths.push_back(paths);
  }
  return out;
}

std::vector<ConvergenceCurve> convergenceCurves(const SweepResults& r, size_t problem, const std::string& reference, const std::string& metric) {
  std::vector<ConvergenceCurve> out;
  if (problem >= r.problems.size()) return out;
  const std::vector<size_t>& configurations = r.problems[problem].configurations;
  for (size_t i = 0; i < r.plan.size(); ++i) {
    const PlannedRun& p = r.plan[i];
    if (!r.runs[i] || !r.runs[i]->failed.empty() || std::find(configurations.begin(), configurations.end(), p.configuration) == configurations.end()) continue;
    ConvergenceCurve c{p.configuration, p.seed, p.repeat, {}, {}, {}, {}};
    for (const ErrorAt& at : r.runs[i]->convergence)
      if (const ErrorValue* e = find(at.errors, reference, metric)) {
        c.frames.push_back(at.frames), c.ms.push_back(at.ms);
        c.errors.push_back(badness(metric, e->value)), c.noiseFloors.push_back(e->noiseFloor);
      }
    if (!c.ms.empty()) out.push_back(std::move(c));
  }
  return out;
}

std::vector<VariedAxis> variedAxes(const SweepResults& r, size_t problem) {
  std::vector<VariedAxis> out;
  if (problem >= r.problems.size()) return out;
  const std::vector<size_t>& configurations = r.problems[problem].configurations;
  for (const std::string& key : variedKeys(r)) {
    VariedAxis axis;
    axis.key = key;
    std::vector<std::string> own(r.configurations.size());
    std::vector<bool> has(r.configurations.size(), false);
    const auto take = [&](size_t c, const std::string& value) {
      own[c] = value, has[c] = true;
      if (std::find(axis.values.begin(), axis.values.end(), value) == axis.values.end()) axis.values.push_back(value);
    };
    for (const size_t c : configurations) {
      if (key == "technique") take(c, r.configurations[c].preset.technique);  // where some permutations vary it, the base's is one of its values
      for (const auto& [k, value] : r.configurations[c].values)
        if (k == key && key != "technique") take(c, value);
    }
    if (axis.values.empty()) continue;
    placeValues(axis);
    axis.byConfiguration.assign(r.configurations.size(), std::numeric_limits<double>::quiet_NaN());
    for (const size_t c : configurations)
      for (size_t i = 0; i < axis.values.size(); ++i)
        if (has[c] && axis.values[i] == own[c]) axis.byConfiguration[c] = axis.places[i];
    out.push_back(std::move(axis));
  }
  return out;
}

std::string shortKey(const SweepResults& r, const std::string& key) {
  int alike = 0;
  for (const std::string& other : variedKeys(r)) alike += lastPart(other) == lastPart(key) ? 1 : 0;
  return alike > 1 ? key : lastPart(key);
}

std::string shortLabel(const SweepResults& r, size_t configuration) {
  const Configuration& c = r.configurations[configuration];
  std::string out;
  for (const auto& [key, value] : c.values) out += fmt::format("{}{}", out.empty() ? "" : ", ", key == "technique" ? value : fmt::format("{} {}", shortKey(r, key), value));
  return out.empty() ? c.preset.technique : out;
}

}  // namespace hl
