#include "engine/metrics/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/metrics/block_mean.h"
#include "engine/metrics/definition.h"

namespace hl {

namespace {

constexpr double kRelativeEpsilon = 0.01;

constexpr std::array kDefinitions{&kMse, &kRmse, &kMae, &kRelmse, &kSmape, &kBias, &kPsnr};

const MetricDefinition& definitionOf(std::string_view id) {
  std::vector<std::string> known;
  for (const MetricDefinition* definition : kDefinitions) {
    if (definition->info.id == id) return *definition;
    known.emplace_back(definition->info.id);
  }
  const std::string near = nearest(std::string(id), known);
  throw badInput(fmt::format("unknown metric '{}'; {}there are {}", id,
                             near.empty() ? "" : fmt::format("did you mean '{}'? ", near), fmt::join(known, ", ")));
}

int usedChannels(const Image& image) { return std::min(image.channels, 3); }

void requireSameShape(const Image& value, const Image& other, const char* name) {
  if (other.width == value.width && other.height == value.height && usedChannels(other) == usedChannels(value)) return;
  throw badInput(fmt::format("the image has {} x {} pixels and {} channels, {} has {} x {} and {}: they must be equal",
                             value.width, value.height, usedChannels(value), name, other.width, other.height,
                             usedChannels(other)));
}

/// A pixel's weight, 0 where it does not count.
std::vector<double> weightsOf(const Image& value, const MeasureOptions& options) {
  const size_t pixels = value.pixels();
  if (!options.mask.empty() && options.mask.size() != pixels)
    throw badInput(fmt::format("the mask has {} pixels, the image {}", options.mask.size(), pixels));
  if (!options.weights.empty() && options.weights.size() != pixels)
    throw badInput(fmt::format("there are {} weights for {} pixels", options.weights.size(), pixels));
  std::vector<double> weights(pixels, 1.0);
  bool any = false;
  for (size_t i = 0; i < pixels; ++i) {
    if (!options.weights.empty()) weights[i] = options.weights[i];
    if (!(weights[i] >= 0) || std::isinf(weights[i]))
      throw badInput(fmt::format("the weight of pixel {} is {}: weights are finite and at least 0", i, weights[i]));
    if (!options.mask.empty() && options.mask[i] == 0) weights[i] = 0;
    any = any || weights[i] > 0;
  }
  if (!any) throw badInput("no pixel counts: the image is empty, or its mask or weights are all 0");
  return weights;
}

/// The images as one access, with the mean in place of halves that are not there.
struct Images {
  const Image &value, &mean, &halfA, &halfB;
  int channels;

  ChannelSample at(size_t pixel, int channel) const {
    const auto read = [&](const Image& image) {
      return static_cast<double>(
          image.data[pixel * static_cast<size_t>(image.channels) + static_cast<size_t>(channel)]);
    };
    return {read(value), read(mean), read(halfA), read(halfB)};
  }

  bool finite(size_t pixel) const {
    for (int c = 0; c < channels; ++c) {
      const ChannelSample sample = at(pixel, c);
      if (!std::isfinite(sample.v) || !std::isfinite(sample.r) || !std::isfinite(sample.a) || !std::isfinite(sample.b))
        return false;
    }
    return true;
  }
};

bool hasHalves(const ReferenceImage& reference) { return reference.halfA.pixels() > 0; }

Images imagesOf(const Image& value, const ReferenceImage& reference) {
  requireSameShape(value, reference.mean, "the reference");
  if (hasHalves(reference) != (reference.halfB.pixels() > 0)) throw badInput("a reference has two halves or none");
  if (!hasHalves(reference)) return {value, reference.mean, reference.mean, reference.mean, usedChannels(value)};
  requireSameShape(value, reference.halfA, "the reference's first half");
  requireSameShape(value, reference.halfB, "the reference's second half");
  return {value, reference.mean, reference.halfA, reference.halfB, usedChannels(value)};
}

ReferenceStatistics statisticsOf(const Images& images, const std::vector<double>& weights, double epsilon) {
  constexpr std::array kLuminance{0.2126, 0.7152, 0.0722};
  double sum = 0, luminanceSum = 0, weightSum = 0, peak = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    for (int c = 0; c < images.channels; ++c) {
      const double r = images.at(i, c).r;
      sum += weights[i] * r / images.channels;
      luminanceSum +=
          weights[i] * r * (images.channels == 3 ? kLuminance[static_cast<size_t>(c)] : 1.0 / images.channels);
      peak = std::max(peak, r);
    }
    weightSum += weights[i];
  }
  ReferenceStatistics s;
  s.mean = sum / weightSum;
  s.epsilon = epsilon > 0 ? epsilon : kRelativeEpsilon * luminanceSum / weightSum;
  if (peak > 0) s.peak = peak;
  return s;
}

using Term = double (*)(const ChannelSample&, const ReferenceStatistics&);

/// The term of each pixel that counts: the mean of its channels'.
std::vector<double> pixelTerms(const Images& images, const std::vector<double>& weights, const ReferenceStatistics& s,
                               Term term) {
  std::vector<double> terms(weights.size(), 0.0);
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    for (int c = 0; c < images.channels; ++c) terms[i] += term(images.at(i, c), s);
    terms[i] /= images.channels;
  }
  return terms;
}

/// One draw of the noise that the reference puts into each pixel's term. In a squared term (t + x)(t + y), x and y the halves' noise of variance s^2,
/// half of what it differs by from one half to the other is (x - y)(t + (x + y)/2): of variance 2 s^2 t^2 + s^4, as the term itself. What holds
/// the mean image has its noise (x + y)/2, of which (x - y)/2 is a draw: to first order.
std::vector<double> noiseOf(const Images& images, const std::vector<double>& weights, const ReferenceStatistics& s, Term term) {
  constexpr double kStep = 1e-3;
  std::vector<double> noise(weights.size(), 0.0);
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    for (int c = 0; c < images.channels; ++c) {
      const ChannelSample x = images.at(i, c);
      const double step = kStep * (x.a - x.b) / 2;
      noise[i] += (term({x.v, x.r, x.a, x.a}, s) - term({x.v, x.r, x.b, x.b}, s)) / 2;
      noise[i] += (term({x.v, x.r + step, x.a, x.b}, s) - term({x.v, x.r - step, x.a, x.b}, s)) / (2 * kStep);
    }
    noise[i] /= images.channels;
  }
  return noise;
}

Image mapOf(const std::vector<double>& terms, const std::vector<double>& weights, double (*mapped)(double), int width,
            int height) {
  Image map(width, height, 1);
  for (size_t i = 0; i < terms.size(); ++i)
    if (weights[i] > 0) map.data[i] = static_cast<float>(mapped ? mapped(terms[i]) : terms[i]);
  return map;
}

}  // namespace

std::span<const MetricInfo> metricInfos() {
  static const auto infos = [] {
    std::array<MetricInfo, kDefinitions.size()> list{};
    std::transform(kDefinitions.begin(), kDefinitions.end(), list.begin(), [](const auto* d) { return d->info; });
    return list;
  }();
  return infos;
}

MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference,
                     const MeasureOptions& options) {
  const MetricDefinition& definition = definitionOf(metric);
  const Images images = imagesOf(value, reference);
  const std::vector<double> weights = weightsOf(value, options);

  MetricResult result;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    ++result.pixels;
    if (!images.finite(i)) ++result.nonFinite;
  }
  const ReferenceStatistics statistics = statisticsOf(images, weights, options.epsilon);
  const std::vector<double> terms = pixelTerms(images, weights, statistics, definition.term);
  if (options.wantMap) result.map = mapOf(terms, weights, definition.mapped, value.width, value.height);
  result.epsilon = statistics.epsilon;
  result.peak = statistics.peak;
  if (result.nonFinite > 0) {
    result.value = result.standardError = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  const BlockMean mean = blockMean(terms, weights, value.width, value.height);
  result.value = mean.mean;
  result.standardError =
      hasHalves(reference) ? blockNoise(noiseOf(images, weights, statistics, definition.term), weights, value.width, value.height) : mean.standardError;
  if (definition.floor)
    result.noiseFloor =
        blockMean(pixelTerms(images, weights, statistics, definition.floor), weights, value.width, value.height).mean;
  if (definition.finish) definition.finish(result, statistics);
  return result;
}

MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference, const Mask& mask,
                     bool wantMap, double epsilon) {
  return measure(metric, value, reference, MeasureOptions{mask, {}, wantMap, epsilon});
}

Mask rectangleMask(int width, int height, const PixelRectangle& r, const Mask& base) {
  if (r.width <= 0 || r.height <= 0 || r.x < 0 || r.y < 0 || r.width > width - r.x || r.height > height - r.y)
    throw badInput(fmt::format("the region {},{},{},{} (x, y, width, height) is not inside an image of {} x {} pixels",
                               r.x, r.y, r.width, r.height, width, height));
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (!base.empty() && base.size() != pixels)
    throw badInput(fmt::format("the mask has {} pixels, the image {}", base.size(), pixels));
  Mask mask(pixels, 0);
  for (int y = r.y; y < r.y + r.height; ++y) {
    for (int x = r.x; x < r.x + r.width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      mask[i] = base.empty() ? 1 : base[i];
    }
  }
  return mask;
}

}  // namespace hl
