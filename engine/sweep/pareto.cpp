#include "engine/sweep/pareto.h"

#include <algorithm>
#include <cmath>

namespace hl {
namespace {

double between(double x, double x0, double x1, double y0, double y1) {
  const double t = (std::log(x) - std::log(x0)) / (std::log(x1) - std::log(x0));
  return std::exp(std::log(y0) + t * (std::log(y1) - std::log(y0)));
}

}  // namespace

std::vector<FrontPlace> paretoFront(std::span<const CostPoint> points) {
  std::vector<FrontPlace> out(points.size(), FrontPlace::On);
  for (size_t i = 0; i < points.size(); ++i) {
    const CostPoint& p = points[i];
    if (!std::isfinite(p.cost) || !std::isfinite(p.error)) {
      out[i] = FrontPlace::Off;
      continue;
    }
    for (const CostPoint& q : points) {
      if (!(q.cost <= p.cost && q.error <= p.error) || (q.cost == p.cost && q.error == p.error)) continue;
      const bool surely = q.error + q.halfWidth < p.error - p.halfWidth && q.cost + q.costHalfWidth <= p.cost - p.costHalfWidth;
      out[i] = surely ? FrontPlace::Off : FrontPlace::Within;
      if (surely) break;
    }
  }
  return out;
}

std::vector<CostPoint> lowerEnvelope(std::span<const CostPoint> points) {
  std::vector<CostPoint> sorted;
  for (CostPoint p : points) {
    if (!(p.error > 0)) p.error = p.error + p.halfWidth;
    if (p.cost > 0 && p.error > 0 && std::isfinite(p.cost) && std::isfinite(p.error)) sorted.push_back(p);
  }
  std::sort(sorted.begin(), sorted.end(), [](const CostPoint& a, const CostPoint& b) { return a.cost != b.cost ? a.cost < b.cost : a.error < b.error; });
  std::vector<CostPoint> out;
  for (const CostPoint& p : sorted)
    if (out.empty() || p.error < out.back().error) out.push_back(p);
  return out;
}

std::optional<double> errorAtCost(std::span<const CostPoint> envelope, double cost) {
  if (envelope.empty() || cost < envelope.front().cost) return std::nullopt;
  for (size_t i = 1; i < envelope.size(); ++i)
    if (cost < envelope[i].cost) return between(cost, envelope[i - 1].cost, envelope[i].cost, envelope[i - 1].error, envelope[i].error);
  return envelope.back().error;
}

std::optional<double> costOfError(std::span<const CostPoint> envelope, double error) {
  if (envelope.empty() || envelope.back().error > error) return std::nullopt;
  if (envelope.front().error <= error) return envelope.front().cost;
  for (size_t i = 1; i < envelope.size(); ++i)
    if (envelope[i].error <= error) return between(error, envelope[i - 1].error, envelope[i].error, envelope[i - 1].cost, envelope[i].cost);
  return std::nullopt;
}

}  // namespace hl
