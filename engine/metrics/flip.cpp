// FLIP of the pictures as they are shown.
#include "engine/metrics/definition.h"
#include "engine/metrics/flip_difference.h"

namespace hl {

namespace {

Image shown(const Image& image, const PictureOptions& o) {
  Image out(image.width, image.height, 3);
  forRows(o.pool, image.height, [&](int first, int end) {
    const size_t row = static_cast<size_t>(image.width) * 3;
    for (size_t i = static_cast<size_t>(first) * row; i < static_cast<size_t>(end) * row; ++i) out.data[i] = o.screen.shown(image.data[i]);
  });
  return out;
}

std::vector<double> map(const Picture& value, const Picture& reference, const PictureOptions& o) {
  const Plane difference = flipDifference(shown(value.image, o), shown(reference.image, o), o.pixelsPerDegree, o.pool);
  return {difference.begin(), difference.end()};
}

}  // namespace

const MetricDefinition kFlip{
    .info = {.id = "flip",
             .label = "FLIP",
             .formula = "mean FLIP of the tone-mapped pictures, 0 to 1, at 67.02 pixels a degree",
             .windowed = true,
             .mapEnd = 1},
    .map = map,
};

}  // namespace hl
