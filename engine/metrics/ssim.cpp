// Structural similarity: Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity", 2004, equation 13, with the
// Gaussian window of their section III.B.
#include "engine/metrics/definition.h"
#include "engine/metrics/separable_filter.h"

namespace hl {

namespace {

constexpr double kSigma = 1.5;
constexpr int kRadius = 5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // (K L)^2 with the range L = 1

/// In double: variances are small differences of means.
using Values = std::vector<double>;

Values signalOf(const Image& image, const Screen& screen, TaskPool* pool) {
  Values out(image.pixels());
  forRows(pool, image.height, [&](int first, int end) {
    for (int y = first; y < end; ++y)
      for (int x = 0; x < image.width; ++x) {
        const float* p = image.pixel(x, y);
        out[static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x)] =
            static_cast<double>(luminance(vec3(screen.signal(p[0]), screen.signal(p[1]), screen.signal(p[2]))));
      }
  });
  return out;
}

std::vector<double> map(const Picture& value, const Picture& reference, const PictureOptions& o) {
  const int width = value.image.width, height = value.image.height;
  const std::vector<double> taps = gaussianTaps(kSigma, kRadius);
  const auto mean = [&](const Values& a) {
    return filterColumns(filterRows(a, width, height, taps, Border::Mirror, o.pool), width, height, taps, Border::Mirror, o.pool);
  };
  const auto product = [](const Values& a, const Values& b) {
    Values out(a.size());
    for (size_t i = 0; i < a.size(); ++i) out[i] = a[i] * b[i];
    return out;
  };
  const Values v = signalOf(value.image, o.screen, o.pool), r = signalOf(reference.image, o.screen, o.pool);
  const Values meanV = mean(v), meanR = mean(r), vv = mean(product(v, v)), rr = mean(product(r, r)), vr = mean(product(v, r));
  std::vector<double> out(v.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const double mv = meanV[i], mr = meanR[i];
    const double varianceV = vv[i] - mv * mv, varianceR = rr[i] - mr * mr, covariance = vr[i] - mv * mr;
    out[i] = (2 * mv * mr + kC1) * (2 * covariance + kC2) / ((mv * mv + mr * mr + kC1) * (varianceV + varianceR + kC2));
  }
  return out;
}

}  // namespace

const MetricDefinition kSsim{
    .info = {.id = "ssim",
             .label = "SSIM",
             .formula = "mean structural similarity of the tone-mapped luminance: 11x11 Gaussian, sigma 1.5, K .01/.03, range 1, borders mirrored",
             .perfect = 1,
             .windowed = true,
             .mapEnd = 1},
    .map = map,
};

}  // namespace hl
