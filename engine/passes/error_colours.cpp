#include "engine/passes/error_colours.h"

#include <algorithm>
#include <cmath>

#include "engine/passes/display.h"

namespace hl {
namespace {

constexpr double kQuantile = 0.98;
constexpr float kLeastEnd = 1e-12f;

float quantile(const Image& map) {
  std::vector<float> sorted;
  for (const float v : map.data)
    if (std::isfinite(v)) sorted.push_back(std::fabs(v));
  if (sorted.empty()) return 1;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return std::max(*at, kLeastEnd);
}

}  // namespace

std::vector<unsigned char> errorColours(const Image& map, const MetricInfo& metric) {
  if (metric.mapSigned) return falseColour(map, quantile(map), ColourScale::Signed);
  if (metric.mapEnd <= 0) return falseColour(map, quantile(map), ColourScale::Viridis);
  Image off = map;  // a similarity is shown as what it lacks
  for (float& v : off.data) v = std::fabs(v - static_cast<float>(metric.perfect));
  return falseColour(off, metric.mapEnd, ColourScale::Magma);
}

}  // namespace hl
