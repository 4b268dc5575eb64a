#include "engine/metrics/separable_filter.h"

#include <algorithm>
#include <cmath>

namespace hl {

namespace {

constexpr size_t kRowsPerTask = 16;

}  // namespace

int borderIndex(int i, int count, Border border) {
  if (border == Border::Clamp) return std::clamp(i, 0, count - 1);
  const int period = 2 * count;
  const int within = ((i % period) + period) % period;
  return within < count ? within : period - 1 - within;
}

void forRows(TaskPool* pool, int height, const std::function<void(int, int)>& body) {
  if (!pool) return body(0, height);
  pool->parallelFor(static_cast<size_t>(height), kRowsPerTask,
                    [&](size_t first, size_t end, unsigned) { body(static_cast<int>(first), static_cast<int>(end)); });
}

template <class T>
std::vector<T> filterRows(const std::vector<T>& in, int width, int height, std::type_identity_t<std::span<const T>> taps, Border border, TaskPool* pool) {
  const int radius = static_cast<int>(taps.size() / 2);
  std::vector<T> out(in.size(), T(0));
  forRows(pool, height, [&](int first, int end) {
    std::vector<T> row(static_cast<size_t>(width + 2 * radius));
    for (int y = first; y < end; ++y) {
      const T* from = in.data() + static_cast<size_t>(y) * static_cast<size_t>(width);
      T* to = out.data() + static_cast<size_t>(y) * static_cast<size_t>(width);
      for (int x = -radius; x < width + radius; ++x) row[static_cast<size_t>(x + radius)] = from[borderIndex(x, width, border)];
      for (size_t k = 0; k < taps.size(); ++k) {
        const T tap = taps[k];
        const T* shifted = row.data() + k;
        for (int x = 0; x < width; ++x) to[x] += tap * shifted[x];
      }
    }
  });
  return out;
}

template <class T>
std::vector<T> filterColumns(const std::vector<T>& in, int width, int height, std::type_identity_t<std::span<const T>> taps, Border border, TaskPool* pool) {
  const int radius = static_cast<int>(taps.size() / 2);
  std::vector<T> out(in.size(), T(0));
  forRows(pool, height, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      T* to = out.data() + static_cast<size_t>(y) * static_cast<size_t>(width);
      for (size_t k = 0; k < taps.size(); ++k) {
        const T tap = taps[k];
        const int row = borderIndex(y + static_cast<int>(k) - radius, height, border);
        const T* from = in.data() + static_cast<size_t>(row) * static_cast<size_t>(width);
        for (int x = 0; x < width; ++x) to[x] += tap * from[x];
      }
    }
  });
  return out;
}

template Plane filterRows<float>(const Plane&, int, int, std::span<const float>, Border, TaskPool*);
template Plane filterColumns<float>(const Plane&, int, int, std::span<const float>, Border, TaskPool*);
template std::vector<double> filterRows<double>(const std::vector<double>&, int, int, std::span<const double>, Border, TaskPool*);
template std::vector<double> filterColumns<double>(const std::vector<double>&, int, int, std::span<const double>, Border, TaskPool*);

std::vector<double> gaussianTaps(double sigma, int radius) {
  std::vector<double> taps;
  double sum = 0;
  for (int x = -radius; x <= radius; ++x) sum += taps.emplace_back(std::exp(-x * x / (2 * sigma * sigma)));
  for (double& tap : taps) tap /= sum;
  return taps;
}

std::vector<float> inFloat(const std::vector<double>& taps) {
  std::vector<float> out;
  for (const double tap : taps) out.push_back(static_cast<float>(tap));
  return out;
}

}  // namespace hl
