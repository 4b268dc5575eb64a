#include <cmath>

#include "engine/metrics/definition.h"

namespace hl {

namespace {

/// CIE 1976 lightness of the colour that the screen gives off, in [0, 1]; its white is the largest value.
double lightness(const double (&c)[3], int channels, const Screen& screen) {
  const auto shown = [&](int k) { return screen.shown(static_cast<float>(c[k])); };
  double y = 0;
  if (channels == 3) y = static_cast<double>(luminance(vec3(shown(0), shown(1), shown(2))));
  if (channels != 3)
    for (int k = 0; k < channels; ++k) y += static_cast<double>(shown(k)) / channels;
  constexpr double kDelta = 6.0 / 29;
  const double f = y > kDelta * kDelta * kDelta ? std::cbrt(y) : y / (3 * kDelta * kDelta) + 4.0 / 29;
  return 1.16 * f - 0.16;
}

}  // namespace

const MetricDefinition kLStarMse{
    .info = {.id = "l_star_mse",
             .label = "L* MSE",
             .formula = "mean (L*(v)-L*(r))^2, lightness of CIE L*a*b* of the tone-mapped picture, scaled to [0, 1]",
             .squared = true},
    .pixelTerm =
        [](const PixelSample& p, const ReferenceStatistics& s) {
          const double v = lightness(p.v, p.channels, s.screen);
          return (v - lightness(p.a, p.channels, s.screen)) * (v - lightness(p.b, p.channels, s.screen));
        },
    .pixelFloor =
        [](const PixelSample& p, const ReferenceStatistics& s) {
          const double d = lightness(p.a, p.channels, s.screen) - lightness(p.b, p.channels, s.screen);
          return d * d / 4;
        },
};

}  // namespace hl
