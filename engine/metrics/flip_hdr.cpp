// FLIP over the exposures at which the reference's light is worth looking at: Andersson et al., "Visualizing Errors in Rendered High Dynamic
// Range Images", 2021.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/metrics/definition.h"
#include "engine/metrics/flip_difference.h"

namespace hl {

namespace {

constexpr float kWhitePoint = 0.85f;        // of the tone-mapped value: what bounds the exposures
constexpr float kCurveScale = 0.6f;         // the paper's ACES curve is the fit with its argument times this
constexpr double kLeastMedian = 1.0 / (1 << 23);  // of the largest luminance: where half the picture is black there are 23 stops to look at

double curve(double x) { return shared::acesCurve(static_cast<float>(x) * kCurveScale); }

/// Where the curve reaches kWhitePoint. It rises all the way.
double brightest() {
  double low = 0, high = 100;
  for (int i = 0; i < 60; ++i) (curve((low + high) / 2) < kWhitePoint ? low : high) = (low + high) / 2;
  return low;
}

struct Exposures {
  double start = 0, stop = 0;
  int count = 1;
};

/// From the brightest pixel just short of white to the median there, in whole stops or a little less.
Exposures exposuresOf(const Picture& reference) {
  std::vector<float> luminances;
  for (size_t i = 0; i < reference.holds.size(); ++i)
    if (reference.holds[i]) {
      const float* p = &reference.image.data[i * 3];
      luminances.push_back(luminance(glm::max(vec3(p[0], p[1], p[2]), vec3(0))));
    }
  if (luminances.empty()) return {};
  const double most = *std::max_element(luminances.begin(), luminances.end());
  if (!(most > 0)) return {};
  const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
  std::nth_element(luminances.begin(), middle, luminances.end());
  const double median = std::max(static_cast<double>(*middle), kLeastMedian * most);
  Exposures e{std::log2(brightest() / most), std::log2(brightest() / median), 0};
  e.count = std::max(2, static_cast<int>(std::ceil(e.stop - e.start)));
  return e;
}

Image exposed(const Image& image, double exposure, TaskPool* pool) {
  const float scale = static_cast<float>(std::exp2(exposure));
  Image out(image.width, image.height, 3);
  forRows(pool, image.height, [&](int first, int end) {
    const size_t row = static_cast<size_t>(image.width) * 3;
    for (size_t i = static_cast<size_t>(first) * row; i < static_cast<size_t>(end) * row; ++i)
      out.data[i] = std::clamp(shared::acesCurve(std::min(std::max(image.data[i], 0.0f) * scale * kCurveScale, 1e9f)), 0.0f, 1.0f);
  });
  return out;
}

std::vector<double> map(const Picture& value, const Picture& reference, const PictureOptions& o) {
  const Exposures e = exposuresOf(reference);
  std::vector<double> most(value.image.pixels(), 0.0);
  for (int i = 0; i < e.count; ++i) {
    const double exposure = e.count > 1 ? e.start + (e.stop - e.start) * i / (e.count - 1) : e.start;
    const Plane difference =
        flipDifference(exposed(value.image, exposure, o.pool), exposed(reference.image, exposure, o.pool), o.pixelsPerDegree, o.pool);
    for (size_t k = 0; k < most.size(); ++k) most[k] = std::max(most[k], static_cast<double>(difference[k]));
  }
  return most;
}

}  // namespace

const MetricDefinition kFlipHdr{
    .info = {.id = "flip_hdr",
             .label = "HDR-FLIP",
             .formula = "mean of the largest FLIP over exposures one stop apart, from start (brightest) to stop (median) of the reference, ACES curve",
             .windowed = true,
             .costly = true,
             .sceneReferred = true,
             .mapEnd = 1},
    .map = map,
};

}  // namespace hl
