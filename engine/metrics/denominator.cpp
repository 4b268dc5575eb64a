#include "engine/metrics/denominator.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/math.h"
#include "engine/metrics/separable_filter.h"

namespace hl {

namespace {

constexpr int kReach = 2, kMostNeighbours = (2 * kReach + 1) * (2 * kReach + 1) - 1;
// Pixels on one surface: the cosine between their normals is above kSameNormal, and the line between them is within kSamePlane (a sine) of both planes.
constexpr float kSameNormal = 0.9f, kSamePlane = 0.1f;
// So few on the pixel's surface say less than all round it; so few for each of a plane's two slopes.
constexpr int kFewest = 4, kFewestForSlope = 8;
// Added to the squared offsets, so that neighbours in a row leave the slope across it at 0.
constexpr double kLevelling = 0.5;
// Darker than the guess by so many standard deviations can be luck; by so many more the guess is wrong, and the pixel is believed.
constexpr double kLuck = 4, kNoLuck = 5;

/// In units in which the reference is smooth across a surface: without the offset, over the gain.
struct Sample {
  float mean[3], half[3];  ///< half: (A - B) / 2, one draw of the mean's noise
};

struct Surface {
  vec3 position, normal;
};

struct Inputs {
  int width, height, channels;
  std::vector<unsigned char> holds;  ///< where a pixel counts
  std::vector<Sample> samples;
  const ReferenceSurfaces* surfaces;

  size_t at(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); }
  float gain(size_t i, int c) const { return surfaces && surfaces->gain.pixels() ? channel(surfaces->gain, i, c) : 1.0f; }
  float offset(size_t i, int c) const { return surfaces && surfaces->offset.pixels() ? channel(surfaces->offset, i, c) : 0.0f; }
  Surface surface(size_t i) const { return {vectorOf(surfaces->position, i), vectorOf(surfaces->normal, i)}; }

 private:
  static float channel(const Image& image, size_t i, int c) { return image.data[i * static_cast<size_t>(image.channels) + static_cast<size_t>(c)]; }
  static vec3 vectorOf(const Image& image, size_t i) { return {channel(image, i, 0), channel(image, i, 1), channel(image, i, 2)}; }
};

bool onOneSurface(const Surface& a, const Surface& b) {
  const vec3 apart = b.position - a.position;
  const float most = kSamePlane * glm::length(apart);
  return glm::dot(a.normal, b.normal) > kSameNormal && std::fabs(glm::dot(a.normal, apart)) <= most && std::fabs(glm::dot(b.normal, apart)) <= most;
}

Inputs inputsOf(const ReferenceImage& reference, const std::vector<double>& weights) {
  const Image& mean = reference.mean;
  Inputs in{mean.width, mean.height, std::min(mean.channels, 3), std::vector<unsigned char>(weights.size(), 0), std::vector<Sample>(weights.size()),
            reference.surfaces.get()};
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      const size_t i = in.at(x, y);
      const float *r = mean.pixel(x, y), *a = reference.halfA.pixel(x, y), *b = reference.halfB.pixel(x, y);
      bool holds = weights[i] > 0;
      Sample& s = in.samples[i];
      for (int c = 0; c < in.channels; ++c) {
        holds = holds && std::isfinite(r[c]) && std::isfinite(a[c]) && std::isfinite(b[c]);
        const float gain = in.gain(i, c);  // 0: black whatever falls on it
        s.mean[c] = gain > 0 ? (r[c] - in.offset(i, c)) / gain : 0.0f;
        s.half[c] = gain > 0 ? (a[c] - b[c]) / 2 / gain : 0.0f;
      }
      in.holds[i] = holds;
    }
  return in;
}

struct Neighbour {
  size_t pixel;
  double dx, dy, weight;  ///< weights add up to 1
};

/// Those whose weighted sum is the fitted plane's value at the pixel.
struct Neighbours {
  std::array<Neighbour, kMostNeighbours> list;
  int count = 0;

  void add(size_t pixel, int dx, int dy) { list[static_cast<size_t>(count++)] = {pixel, static_cast<double>(dx), static_cast<double>(dy), 0}; }
  std::span<Neighbour> all() { return {list.data(), static_cast<size_t>(count)}; }

  void weigh() {
    double sumX = 0, sumY = 0, sumXX = kLevelling, sumXY = 0, sumYY = kLevelling;
    for (const Neighbour& n : all()) sumX += n.dx, sumY += n.dy;
    const double meanX = sumX / count, meanY = sumY / count;
    for (const Neighbour& n : all())
      sumXX += (n.dx - meanX) * (n.dx - meanX), sumXY += (n.dx - meanX) * (n.dy - meanY), sumYY += (n.dy - meanY) * (n.dy - meanY);
    const double determinant = sumXX * sumYY - sumXY * sumXY;
    const bool sloped = count >= kFewestForSlope;
    const double slopeX = sloped ? (sumYY * meanX - sumXY * meanY) / determinant : 0, slopeY = sloped ? (sumXX * meanY - sumXY * meanX) / determinant : 0;
    for (Neighbour& n : all()) n.weight = 1.0 / count - slopeX * (n.dx - meanX) - slopeY * (n.dy - meanY);
  }
};

Neighbours neighboursOf(const Inputs& in, int x, int y) {
  const auto collect = [&](bool anySurface) {
    Neighbours out;
    const Surface own = anySurface ? Surface{} : in.surface(in.at(x, y));
    for (int dy = -kReach; dy <= kReach; ++dy)
      for (int dx = -kReach; dx <= kReach; ++dx) {
        if ((dx == 0 && dy == 0) || x + dx < 0 || y + dy < 0 || x + dx >= in.width || y + dy >= in.height) continue;
        const size_t i = in.at(x + dx, y + dy);
        if (in.holds[i] && (anySurface || onOneSurface(own, in.surface(i)))) out.add(i, dx, dy);
      }
    return out;
  };
  Neighbours out;
  if (in.surfaces) out = collect(false);
  if (out.count < kFewest) out = collect(true);
  if (out.count > 0) out.weigh();
  return out;
}

}  // namespace

CalmedReference calmedReference(const ReferenceImage& reference, const std::vector<double>& weights, TaskPool* pool) {
  const Inputs in = inputsOf(reference, weights);
  const Image blank(in.width, in.height, in.channels);
  CalmedReference out{blank, blank, blank, blank, blank};
  std::fill(out.own.data.begin(), out.own.data.end(), 1.0f);
  const auto fill = [&](int x, int y) {
    const size_t i = in.at(x, y);
    Neighbours neighbours = neighboursOf(in, x, y);
    if (neighbours.count == 0) return;  // alone: its own value, as it stands
    for (int c = 0; c < in.channels; ++c) {
      const auto channel = static_cast<size_t>(c);
      const auto square = [&](size_t pixel) { return static_cast<double>(in.samples[pixel].half[channel]) * static_cast<double>(in.samples[pixel].half[channel]); };
      double guess = 0, draw = 0, variance = square(i), weightSquares = 0;
      for (const Neighbour& n : neighbours.all()) {
        guess += n.weight * static_cast<double>(in.samples[n.pixel].mean[channel]);
        draw += n.weight * static_cast<double>(in.samples[n.pixel].half[channel]);
        variance += square(n.pixel);
        weightSquares += n.weight * n.weight;
      }
      variance /= neighbours.count + 1;
      const double gain = static_cast<double>(in.gain(i, c)), ofGuess = weightSquares * variance;
      double deviation = gain * std::sqrt(variance);
      guess = static_cast<double>(in.offset(i, c)) + gain * guess;
      const double level = std::max(guess, gain * std::sqrt(ofGuess)), r = static_cast<double>(reference.mean.pixel(x, y)[c]);
      // A dark pixel's noise is less than its neighbours', by as much as it is darker; below 0, where no light is, there is nothing but noise.
      const double darker = level > 0 ? std::clamp(r / level, 0.0, 1.0) : 1;
      const double surely = deviation > 0 && r >= 0 ? std::clamp(((level - r) / deviation - kLuck) / (kNoLuck - kLuck), 0.0, 1.0) : 0;
      const double calm = deviation > 0 ? std::min(1.0, kOwnNoise * level / deviation) : 1, own = calm + (1 - calm) * surely;
      deviation *= 1 - surely * (1 - darker);
      out.guess.pixel(x, y)[c] = static_cast<float>(guess);
      out.own.pixel(x, y)[c] = static_cast<float>(own);
      out.variance.pixel(x, y)[c] = static_cast<float>(deviation * deviation);
      // E[1 / (rho + d)^2] is (1 + 3 var(d) / rho^2) / rho^2; over rho^2 + 3 var(d) it is 1 / rho^2.
      out.spread.pixel(x, y)[c] = static_cast<float>(3 * (1 - own) * (1 - own) * gain * gain * ofGuess);
      out.noise.pixel(x, y)[c] = static_cast<float>(gain * draw);
    }
  };
  forRows(pool, in.height, [&](int first, int end) {
    for (int y = first; y < end; ++y)
      for (int x = 0; x < in.width; ++x)
        if (in.holds[in.at(x, y)]) fill(x, y);
  });
  return out;
}

}  // namespace hl
