// Squared error taken apart: what all seeds get wrong alike, and what differs from seed to seed.
#include <cmath>
#include <map>

#include "engine/sweep/summary.h"

namespace hl {

BiasVariance biasAndVariance(const std::vector<Image>& images, double pixels, const std::vector<double>& mse, double referenceError) {
  const int count = static_cast<int>(images.size());
  const size_t values = images.front().data.size(), channels = static_cast<size_t>(images.front().channels);
  // The sample variance from sums about the first image, whose digits then don't cancel.
  std::vector<double> sum(values, 0), squares(values, 0);
  for (const Image& image : images)
    for (size_t i = 0; i < values; ++i) {
      const double d = static_cast<double>(image.data[i]) - static_cast<double>(images.front().data[i]);
      sum[i] += d, squares[i] += d * d;
    }
  const auto variance = [&](int without) {
    const double n = without < 0 ? count : count - 1;
    double total = 0;
    for (size_t i = 0; i < values; ++i) {
      double s = sum[i], q = squares[i];
      if (without >= 0) {
        const double d = static_cast<double>(images[static_cast<size_t>(without)].data[i]) - static_cast<double>(images.front().data[i]);
        s -= d, q -= d * d;
      }
      total += (q - s * s / n) / (n - 1);
    }
    return total / (pixels * static_cast<double>(channels));
  };
  std::map<int, double> known;  // both statistics ask for it
  const auto varianceOnce = [&](int without) {
    const auto [at, fresh] = known.emplace(without, 0.0);
    if (fresh) at->second = variance(without);
    return at->second;
  };
  const auto biasSquared = [&](int without) {
    double mean = 0;
    for (int s = 0; s < count; ++s)
      if (s != without) mean += mse[static_cast<size_t>(s)] / (without < 0 ? count : count - 1);
    return mean - varianceOnce(without);
  };
  BiasVariance out;
  out.variance = jackknife(count, 3, varianceOnce);
  out.biasSquared = jackknife(count, 3, biasSquared);
  out.biasSquared.halfWidth = std::hypot(out.biasSquared.halfWidth, 1.96 * referenceError);
  return out;
}

}  // namespace hl
