#include "engine/metrics/denominator.h"

#include <algorithm>
#include <cmath>

#include "engine/metrics/separable_filter.h"

namespace hl {

namespace {

constexpr int kReach = 2, kSide = 2 * kReach + 1;
constexpr float kEdge = 0.9f;    // of the local mean: values this far apart are on two sides of an edge
constexpr float kSupport = 1.0f;  // neighbours
constexpr float kNoise = 1e-5f;  // a sum's own rounding

/// Planes with a border of kReach zeros, so that windows need no care.
struct Padded {
  int width, height;
  size_t stride() const { return static_cast<size_t>(width + 2 * kReach); }
  size_t size() const { return stride() * static_cast<size_t>(height + 2 * kReach); }
  size_t at(int x, int y) const { return static_cast<size_t>(y + kReach) * stride() + static_cast<size_t>(x + kReach); }
};

struct Inputs {
  Padded shape;
  int channels;
  Plane holds;                         ///< 1 where a pixel counts; the others are 0 there
  Plane value[3], reference[3], half[3];  ///< half: (A - B) / 2
};

/// Sums over the window, without the pixel itself.
Plane othersOf(const Plane& in, const Padded& p, TaskPool* pool) {
  Plane rows(p.size(), 0.0f), out(p.size(), 0.0f);
  forRows(pool, p.height, [&](int first, int end) {
    for (int y = first; y < end; ++y)
      for (int k = -kReach; k <= kReach; ++k) {
        const float* from = &in[p.at(0, y)] + k;
        float* to = &rows[p.at(0, y)];
        for (int x = 0; x < p.width; ++x) to[x] += from[x];
      }
  });
  forRows(pool, p.height, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      float* to = &out[p.at(0, y)];
      for (int k = -kReach; k <= kReach; ++k) {
        const float* from = &rows[p.at(0, y + k)];
        for (int x = 0; x < p.width; ++x) to[x] += from[x];
      }
      const float* own = &in[p.at(0, y)];
      for (int x = 0; x < p.width; ++x) to[x] -= own[x];
    }
  });
  return out;
}

/// The value as the mean of those neighbours, itself among them, whose colour is near its own, by Tukey's weight. Where they are less than kSupport in
/// all, the pixel stands alone (a firefly): there it is the mean of the others.
void smooth(const Inputs& in, const Plane& count, TaskPool* pool, Plane (&out)[3]) {
  const Padded& p = in.shape;
  Plane means[3];
  for (int c = 0; c < in.channels; ++c) means[c] = othersOf(in.value[c], p, pool), out[c].assign(p.size(), 0.0f);
  forRows(pool, p.height, [&](int first, int end) {
    const size_t width = static_cast<size_t>(p.width);
    std::vector<float> perReach(width), apart(width), weights(width), near(width);
    for (int y = first; y < end; ++y) {
      const size_t row = p.at(0, y);
      std::fill(weights.begin(), weights.end(), 0.0f);
      for (size_t x = 0; x < width; ++x) {
        float squares = 0;
        for (int c = 0; c < in.channels; ++c) {
          const float mean = (means[c][row + x] + in.value[c][row + x]) / (count[row + x] + 1);
          squares += mean * mean;
        }
        perReach[x] = squares > 0 ? 1 / (kEdge * kEdge * squares) : 0;
      }
      for (int k = 0; k < kSide * kSide; ++k) {  // the pixel itself among them, with weight 1
        const size_t shifted = p.at(k % kSide - kReach, y + k / kSide - kReach);
        std::fill(apart.begin(), apart.end(), 0.0f);
        for (int c = 0; c < in.channels; ++c) {
          const float *own = &in.value[c][row], *other = &in.value[c][shifted];
          for (size_t x = 0; x < width; ++x) apart[x] += (other[x] - own[x]) * (other[x] - own[x]);
        }
        const float* holds = &in.holds[shifted];
        for (size_t x = 0; x < width; ++x) {
          const float close = std::max(1 - apart[x] * perReach[x], 0.0f);
          near[x] = close * close * holds[x];
          weights[x] += near[x];
        }
        for (int c = 0; c < in.channels; ++c) {
          const float* other = &in.value[c][shifted];
          float* to = &out[c][row];
          for (size_t x = 0; x < width; ++x) to[x] += near[x] * other[x];
        }
      }
      for (int c = 0; c < in.channels; ++c)
        for (size_t x = 0; x < width; ++x) {
          float& smoothed = out[c][row + x];
          const bool alone = weights[x] < 1 + kSupport && count[row + x] > 0;
          smoothed = in.holds[row + x] == 0 ? 0 : alone ? means[c][row + x] / count[row + x] : smoothed / weights[x];
        }
    }
  });
}

Inputs inputsOf(const Image& value, const ReferenceImage& reference, const std::vector<double>& weights) {
  Inputs in{{value.width, value.height}, std::min(value.channels, 3), {}, {}, {}, {}};
  const Padded& p = in.shape;
  in.holds.assign(p.size(), 0.0f);
  for (int c = 0; c < in.channels; ++c)
    for (Plane* plane : {&in.value[c], &in.reference[c], &in.half[c]}) plane->assign(p.size(), 0.0f);
  for (int y = 0; y < value.height; ++y)
    for (int x = 0; x < value.width; ++x) {
      const float *v = value.pixel(x, y), *r = reference.mean.pixel(x, y), *a = reference.halfA.pixel(x, y), *b = reference.halfB.pixel(x, y);
      bool holds = weights[static_cast<size_t>(y) * static_cast<size_t>(value.width) + static_cast<size_t>(x)] > 0;
      for (int c = 0; c < in.channels; ++c) holds = holds && std::isfinite(v[c]) && std::isfinite(r[c]) && std::isfinite(a[c]) && std::isfinite(b[c]);
      if (!holds) continue;
      const size_t at = p.at(x, y);
      in.holds[at] = 1;
      for (int c = 0; c < in.channels; ++c) in.value[c][at] = v[c], in.reference[c][at] = r[c], in.half[c][at] = (a[c] - b[c]) / 2;
    }
  return in;
}

}  // namespace

CalmedReference calmedReference(const Image& value, const ReferenceImage& reference, const std::vector<double>& weights, TaskPool* pool) {
  const Inputs in = inputsOf(value, reference, weights);
  const Padded& p = in.shape;
  const Plane count = othersOf(in.holds, p, pool);
  Plane smoothed[3];
  smooth(in, count, pool, smoothed);
  const Image blank(p.width, p.height, in.channels);
  CalmedReference out{blank, blank, blank, blank};
  for (int c = 0; c < in.channels; ++c) {
    Plane squares(p.size());
    for (size_t i = 0; i < squares.size(); ++i) squares[i] = in.half[c][i] * in.half[c][i];
    const Plane values = othersOf(smoothed[c], p, pool), references = othersOf(in.reference[c], p, pool);
    const Plane halves = othersOf(in.half[c], p, pool), variances = othersOf(squares, p, pool);
    forRows(pool, p.height, [&](int first, int end) {
      for (int y = first; y < end; ++y)
        for (int x = 0; x < p.width; ++x) {
          const size_t i = p.at(x, y);
          float &guess = out.guess.pixel(x, y)[c], &trust = out.own.pixel(x, y)[c], &variance = out.variance.pixel(x, y)[c];
          trust = 1;
          if (in.holds[i] == 0 || count[i] == 0) continue;
          const float own = smoothed[c][i], scale = values[i] > kNoise * std::fabs(own) ? own / values[i] : 1 / count[i];
          guess = scale * references[i], variance = (variances[i] + squares[i]) / (count[i] + 1);
          out.noise.pixel(x, y)[c] = scale * halves[i];
          constexpr float kMost = kUncertain * kUncertain, kLeast = kCertain * kCertain;
          // A black pixel among black ones, without any noise, is certain too.
          const float level = std::min(std::fabs(guess), std::fabs(references[i]) / count[i]), light = std::max(level * level, 1e-30f);
          trust = variance > 0 ? std::clamp((kMost * light - variance) / ((kMost - kLeast) * light), 0.0f, 1.0f) : 1;
        }
    });
  }
  return out;
}

}  // namespace hl
