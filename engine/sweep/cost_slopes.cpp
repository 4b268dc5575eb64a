#include "engine/sweep/cost_slopes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

namespace hl {
namespace {

constexpr size_t kLeastPoints = 3;

std::optional<double> numberOf(const std::string& text) {
  double v = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), v);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size()) return std::nullopt;
  return v;
}

/// A counter of the configuration's first good run.
std::optional<double> counterOf(const SweepResults& r, size_t configuration, const std::string& name) {
  for (size_t i = 0; i < r.plan.size(); ++i)
    if (r.plan[i].configuration == configuration && r.runs[i] && r.runs[i]->failed.empty())
      if (const auto found = r.runs[i]->counters.find(name); found != r.runs[i]->counters.end()) return found->second;
  return std::nullopt;
}

/// What a parameter's value makes of the scene's quantities.
std::pair<std::string, std::optional<double>> quantityOf(const SweepResults& r, size_t configuration, const std::string& key, double value) {
  if (key.ends_with(".sh_order")) return {"bands", value + 1};
  if (key.starts_with("probes.")) return {"probes", counterOf(r, configuration, "probes")};
  if (key.starts_with("lightmap.")) {
    if (const auto receivers = counterOf(r, configuration, "receivers")) return {"receivers", receivers};
    return {"lumels", counterOf(r, configuration, "lumels")};
  }
  return {key, value};
}

/// Varied parameters that all members have at the same value, but for `key`.
std::string fixedBeside(const SweepResults& r, const std::vector<const ConfigurationSummary*>& members, const std::string& key) {
  std::string text;
  for (const auto& [name, value] : r.configurations[members.front()->configuration].values) {
    const bool same = std::all_of(members.begin(), members.end(), [&](const ConfigurationSummary* c) {
      const auto& values = r.configurations[c->configuration].values;
      return std::any_of(values.begin(), values.end(), [&](const auto& v) { return v.first == name && v.second == value; });
    });
    if (name != key && same) text += (text.empty() ? "" : ", ") + name + " " + value;
  }
  return text;
}

}  // namespace

std::pair<double, double> logLogSlope(const std::vector<std::pair<double, double>>& points) {
  const auto n = static_cast<double>(points.size());
  double mx = 0, my = 0;
  for (const auto& [x, y] : points) mx += std::log(x) / n, my += std::log(y) / n;
  double xx = 0, xy = 0, yy = 0;
  for (const auto& [x, y] : points) {
    const double dx = std::log(x) - mx, dy = std::log(y) - my;
    xx += dx * dx, xy += dx * dy, yy += dy * dy;
  }
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (!(xx > 0)) return {kUnknown, kUnknown};
  const double slope = xy / xx;
  return {slope, n > 2 ? std::sqrt(std::max(0.0, yy - slope * xy) / (n - 2) / xx) : kUnknown};
}

std::vector<CostSlope> costSlopes(const SweepResults& r, const Summary& s) {
  std::vector<CostSlope> out;
  std::vector<std::string> keys;
  for (const Configuration& c : r.configurations)
    for (const auto& [key, unused] : c.values)
      if (key.find('.') != std::string::npos && std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  for (const std::string& key : keys) {
    // By all that is not varied here.
    std::map<std::pair<size_t, std::string>, std::vector<const ConfigurationSummary*>> groups;
    for (const ConfigurationSummary& c : s.configurations) {
      Preset rest = r.configurations[c.configuration].preset;
      if (c.failed == c.runs || rest.parameters.erase(key) == 0) continue;
      groups[{c.problem, presetHash(rest) + rest.technique}].push_back(&c);
    }
    for (const auto& [group, members] : groups) {
      std::map<std::string, std::vector<std::pair<double, double>>> byCost;
      std::string quantity;
      for (const ConfigurationSummary* c : members) {
        const auto value = numberOf(r.configurations[c->configuration].preset.parameters.at(key));
        if (!value) continue;
        const auto [name, x] = quantityOf(r, c->configuration, key, *value);
        if (!x || !(*x > 0)) continue;
        quantity = name;
        for (const auto& [cost, y] : {std::pair{"technique_ms", c->techniqueMs.median}, std::pair{"bake_ms", c->bakeMs()}, std::pair{"technique_bytes", c->techniqueBytes}})
          if (y > 0) byCost[cost].push_back({*x, y});
      }
      for (auto& [cost, points] : byCost) {
        std::sort(points.begin(), points.end());
        size_t different = points.empty() ? 0 : 1;
        for (size_t i = 1; i < points.size(); ++i) different += points[i].first > points[i - 1].first;
        if (different < kLeastPoints) continue;
        CostSlope slope{group.first, key, fixedBeside(r, members, key), quantity, cost, points, 0, 0};
        std::tie(slope.slope, slope.standardError) = logLogSlope(points);
        out.push_back(std::move(slope));
      }
    }
  }
  return out;
}

std::vector<WithinTarget> withinTarget(const SweepResults& r, const Summary& s) {
  std::vector<WithinTarget> out;
  if (!(r.experiment.targetError > 0)) return out;
  for (const Front& f : s.fronts) {
    WithinTarget w{f.problem, f.reference, f.axis, {}, 0, 0};
    for (const FrontPoint& p : f.points) {
      const double above = std::isfinite(p.point.halfWidth) ? p.point.halfWidth : 0;
      if (p.point.error + above > r.experiment.targetError || (w.configuration && p.point.cost >= w.cost)) continue;
      w.configuration = p.configuration, w.cost = p.point.cost, w.error = p.point.error;
    }
    out.push_back(w);
  }
  return out;
}

}  // namespace hl
