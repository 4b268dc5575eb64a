#pragma once
// Filters that are a product of one over rows and one over columns.
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "engine/core/task_pool.h"

namespace hl {

/// What a filter sees past the border: the border's own value again, or the image mirrored with its border repeated (c b a | a b c | c b a).
enum class Border { Clamp, Mirror };

/// One channel, rows from the top, width * height values.
using Plane = std::vector<float>;

/// Where index `i` past the ends of [0, count) is read; any `i`, count at least 1.
int borderIndex(int i, int count, Border border);

/// T is float or double. `taps` (an odd number) along rows, or along columns. The value at x is the sum of taps[k] * in[x + k - taps.size() / 2].
template <class T>
std::vector<T> filterRows(const std::vector<T>& in, int width, int height, std::type_identity_t<std::span<const T>> taps, Border, TaskPool*);
template <class T>
std::vector<T> filterColumns(const std::vector<T>& in, int width, int height, std::type_identity_t<std::span<const T>> taps, Border, TaskPool*);

/// body(first row, end row), by the pool's workers where there is one.
void forRows(TaskPool*, int height, const std::function<void(int first, int end)>& body);

/// exp(-x^2 / (2 sigma^2)) at whole x from -radius to radius, with sum 1.
std::vector<double> gaussianTaps(double sigma, int radius);
std::vector<float> inFloat(const std::vector<double>& taps);

}  // namespace hl
