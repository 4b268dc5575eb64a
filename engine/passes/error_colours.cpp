#include "engine/passes/error_colours.h"

#include <cmath>

#include "engine/passes/display.h"

namespace hl {
std::vector<unsigned char> errorColours(const Image& map, const MetricInfo& metric) {
  if (metric.mapSigned) return falseColour(map, colourScale(map), ColourScale::Signed);
  if (metric.mapEnd <= 0) return falseColour(map, colourScale(map), ColourScale::Viridis);
  Image off = map;  // a similarity is shown as what it lacks
  for (float& v : off.data) v = std::fabs(v - static_cast<float>(metric.perfect));
  return falseColour(off, metric.mapEnd, ColourScale::Magma);
}

}  // namespace hl
