#include "engine/metrics/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/math.h"
#include "engine/metrics/block_mean.h"
#include "engine/metrics/definition.h"
#include "engine/metrics/denominator.h"

namespace hl {

namespace {

constexpr double kRelativeEpsilon = 0.01;

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

constexpr std::array kDefinitions{&kMse, &kRmse, &kMae, &kRelmse, &kSmape, &kBias, &kPsnr, &kSsim, &kFlip, &kFlipHdr, &kLStarMse, &kDfpr};

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
  const CalmedReference* calmed = nullptr;  ///< below the line; null: the mean

  PixelSample at(size_t pixel) const {
    PixelSample s{};
    s.channels = channels;
    const auto read = [&](const Image& image, double (&to)[3]) {
      const float* from = image.data.data() + pixel * static_cast<size_t>(image.channels);
      for (int c = 0; c < channels; ++c) to[c] = static_cast<double>(from[c]);
    };
    read(value, s.v), read(mean, s.r), read(halfA, s.a), read(halfB, s.b);
    if (calmed) read(calmed->guess, s.guess), read(calmed->variance, s.variance), read(calmed->own, s.own), read(calmed->spread, s.spread), read(calmed->noise, s.guessDraw);
    if (!calmed)
      for (int c = 0; c < channels; ++c) s.own[c] = 1;
    return s;
  }

  bool finite(size_t pixel) const {
    const PixelSample s = at(pixel);
    for (int c = 0; c < channels; ++c)
      if (!std::isfinite(s.v[c]) || !std::isfinite(s.r[c]) || !std::isfinite(s.a[c]) || !std::isfinite(s.b[c])) return false;
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

ReferenceStatistics statisticsOf(const Images& images, const std::vector<double>& weights, const MeasureOptions& options) {
  double sum = 0, luminanceSum = 0, weightSum = 0, peak = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    const PixelSample sample = images.at(i);
    for (int c = 0; c < images.channels; ++c) {
      const double r = sample.r[c];
      sum += weights[i] * r / images.channels;
      if (images.channels != 3) luminanceSum += weights[i] * r / images.channels;
      peak = std::max(peak, r);
    }
    if (images.channels == 3) luminanceSum += weights[i] * static_cast<double>(luminance(vec3(static_cast<float>(sample.r[0]), static_cast<float>(sample.r[1]), static_cast<float>(sample.r[2]))));
    weightSum += weights[i];
  }
  ReferenceStatistics s;
  s.mean = sum / weightSum;
  s.epsilon = options.epsilon > 0 ? options.epsilon : kRelativeEpsilon * luminanceSum / weightSum;
  if (peak > 0) s.peak = peak;
  s.screen = Screen(options.appearance);
  return s;
}

/// A pixel's term: its own, or the mean of its channels'.
template <class PerChannel, class PerPixel>
double termOf(const PixelSample& p, const ReferenceStatistics& s, PerChannel channel, PerPixel pixel) {
  if (pixel) return pixel(p, s);
  double sum = 0;
  for (int c = 0; c < p.channels; ++c) sum += channel(p.channel(c), s);
  return sum / p.channels;
}

template <class Term>
std::vector<double> pixelTerms(const Images& images, const std::vector<double>& weights, const Term& term) {
  std::vector<double> terms(weights.size(), 0.0);
  for (size_t i = 0; i < weights.size(); ++i)
    if (weights[i] != 0) terms[i] = term(images.at(i));
  return terms;
}

/// One draw of the noise that the reference puts into a pixel's term. In a squared term (t + x)(t + y), x and y the halves' noise of variance s^2,
/// half of what it differs by from one half to the other is (x - y)(t + (x + y)/2): of variance 2 s^2 t^2 + s^4, as the term itself. What holds
/// the mean image has its noise (x + y)/2, of which (x - y)/2 is a draw: to first order. Likewise denominators.
template <class Term>
double noiseDraw(const PixelSample& p, const Term& term) {
  constexpr double kStep = 1e-3;
  const auto with = [&](const double (&a)[3], const double (&b)[3], double step) {
    PixelSample q = p;
    for (int c = 0; c < p.channels; ++c) q.r[c] += step * (p.a[c] - p.b[c]) / 2, q.guess[c] += step * p.guessDraw[c], q.a[c] = a[c], q.b[c] = b[c];
    return term(q);
  };
  return (with(p.a, p.a, 0) - with(p.b, p.b, 0)) / 2 + (with(p.a, p.b, kStep) - with(p.a, p.b, -kStep)) / (2 * kStep);
}

/// The images as windowed metrics see them.
struct Pictures {
  Mask holds;
  Image value, reference;
};

Pictures picturesOf(const Images& images, const std::vector<double>& weights, std::string_view metric) {
  if (images.channels == 2) throw badInput(fmt::format("{} looks at colour: images of one channel or of three are wanted, not of two", metric));
  Pictures out{Mask(weights.size(), 0), Image(images.value.width, images.value.height, 3), Image(images.value.width, images.value.height, 3)};
  for (size_t i = 0; i < weights.size(); ++i) {
    const PixelSample p = images.at(i);
    const bool finite = images.finite(i), holds = weights[i] > 0 && finite;
    out.holds[i] = holds;
    for (size_t c = 0; c < 3; ++c) {
      const size_t from = images.channels == 1 ? 0 : c;
      out.reference.data[3 * i + c] = std::isfinite(p.r[from]) ? static_cast<float>(p.r[from]) : 0;
      out.value.data[3 * i + c] = holds ? static_cast<float>(p.v[from]) : out.reference.data[3 * i + c];
    }
  }
  return out;
}

std::vector<double> windowedTerms(const MetricDefinition& definition, const Images& images, const std::vector<double>& weights, const MeasureOptions& options) {
  const Pictures p = picturesOf(images, weights, definition.info.id);
  std::vector<double> terms =
      definition.map({p.value, p.holds}, {p.reference, p.holds}, {Screen(options.appearance), options.appearance.pixelsPerDegree, options.pool});
  for (size_t i = 0; i < terms.size(); ++i)
    if (weights[i] > 0 && !p.holds[i]) terms[i] = kNotKnown;
  return terms;
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

const MetricInfo& metricInfo(std::string_view id) { return definitionOf(id).info; }

namespace {

/// One metric over pixels of one image; what is the same for every region is there already.
struct Measurement {
  const MetricDefinition& definition;
  const Images& images;
  bool halves;
  const MeasureOptions& options;
  const std::vector<double>* windowed;  ///< terms of a windowed metric

  MetricResult over(const std::vector<double>& weights) const;
};

MetricResult Measurement::over(const std::vector<double>& weights) const {
  const int width = images.value.width, height = images.value.height;
  MetricResult result;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    ++result.pixels;
    if (!images.finite(i)) ++result.nonFinite;
  }
  if (result.pixels == 0) throw badInput("no pixel counts: the image is empty, or its mask, weights or region are all 0");
  const ReferenceStatistics s = statisticsOf(images, weights, options);
  const auto term = [&](const PixelSample& p) { return termOf(p, s, definition.term, definition.pixelTerm); };
  const std::vector<double> own = windowed ? std::vector<double>() : pixelTerms(images, weights, term);
  const std::vector<double>& terms = windowed ? *windowed : own;
  if (options.wantMap) result.map = mapOf(terms, weights, definition.mapped, width, height);
  result.epsilon = s.epsilon;
  result.peak = s.peak;
  if (result.nonFinite > 0) {
    result.value = result.standardError = result.noiseFloor = kNotKnown;
    return result;
  }
  const BlockMean mean = blockMean(terms, weights, width, height);
  result.value = mean.mean;
  result.standardError = mean.standardError;
  if (halves) {
    const auto noise = [&](const PixelSample& p) { return noiseDraw(p, term); };
    result.standardError = windowed ? kNotKnown : blockNoise(pixelTerms(images, weights, noise), weights, width, height);
  }
  result.noiseFloor = kNotKnown;
  if (halves && (definition.floor || definition.pixelFloor)) {
    const auto floor = [&](const PixelSample& p) { return termOf(p, s, definition.floor, definition.pixelFloor); };
    result.noiseFloor = blockMean(pixelTerms(images, weights, floor), weights, width, height).mean;
  }
  if (definition.finish) definition.finish(result, s);
  return result;
}

}  // namespace

std::vector<MetricResult> measureRegions(std::string_view metric, const Image& value, const ReferenceImage& reference, const MeasureOptions& options,
                                         std::span<const Mask> regions) {
  const MetricDefinition& definition = definitionOf(metric);
  Images images = imagesOf(value, reference);
  const std::vector<double> weights = weightsOf(value, options);
  const bool halves = hasHalves(reference);
  CalmedReference calmed;
  if (halves && definition.calmDenominator) calmed = calmedReference(reference, weights, options.pool), images.calmed = &calmed;
  std::vector<double> windowed;
  if (definition.map) windowed = windowedTerms(definition, images, weights, options);
  const Measurement measurement{definition, images, halves, options, definition.map ? &windowed : nullptr};
  std::vector<MetricResult> out;
  for (const Mask& region : regions) {
    if (!region.empty() && region.size() != weights.size())
      throw badInput(fmt::format("the region's mask has {} pixels, the image {}", region.size(), weights.size()));
    std::vector<double> part = weights;
    if (!region.empty())
      for (size_t i = 0; i < part.size(); ++i)
        if (region[i] == 0) part[i] = 0;
    out.push_back(measurement.over(part));
  }
  return out;
}

MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference, const MeasureOptions& options) {
  const Mask everything;
  return std::move(measureRegions(metric, value, reference, options, {&everything, 1}).front());
}

MetricResult measure(std::string_view metric, const Image& value, const ReferenceImage& reference, const Mask& mask,
                     bool wantMap, double epsilon) {
  MeasureOptions options;
  options.mask = mask, options.wantMap = wantMap, options.epsilon = epsilon;
  return measure(metric, value, reference, options);
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
