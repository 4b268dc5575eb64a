#include "engine/lightmap/pack.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hl {
namespace {

constexpr double kMinTexels = 0.5;    ///< least extent of a chart, so that its corners stay apart in float
constexpr double kSnapTexels = 4;     ///< from here on extents are rounded to whole texels, so that border texels are covered whole
constexpr double kInset = 2e-3;       ///< texels between a chart and the border of its cell: rounding never reaches the next texel
constexpr double kMarginWorth = 0.7;  ///< a margin may cost this share of the density, else a narrower one is taken
constexpr int kBisections = 16;

struct Extent {
  double texels;
  int cells;
};

Extent extentOf(double metres, double scale) {
  const double x = metres * scale;
  if (x >= kSnapTexels) {
    const int n = static_cast<int>(std::lround(std::min(x, 1e6)));
    return {static_cast<double>(n), n};
  }
  const double texels = std::max(x, kMinTexels);
  return {texels, std::max(1, static_cast<int>(std::ceil(texels - 1e-9)))};
}

/// The upper outline of what has been placed, as segments from left to right.
class Skyline {
 public:
  Skyline(int width, int height) : width_(width), height_(height) { segments_.push_back({0, 0, width}); }

  /// Lowest place, leftmost among equals; false where there is none.
  bool place(int w, int h, ivec2& at) {
    if (w > width_ || h > height_) return false;
    size_t best = segments_.size();
    int bestY = height_ - h + 1;
    for (size_t i = 0; i < segments_.size(); ++i) {
      if (segments_[i].x + w > width_) break;
      const int y = restingHeight(i, w, bestY);
      if (y < bestY) bestY = y, best = i;
    }
    if (best == segments_.size()) return false;
    at = {segments_[best].x, bestY};
    cover(best, w, bestY + h);
    return true;
  }

 private:
  struct Segment {
    int x, y, width;
  };

  int restingHeight(size_t first, int w, int limit) const {
    int y = 0, left = w;
    for (size_t i = first; left > 0; ++i) {
      y = std::max(y, segments_[i].y);
      if (y >= limit) return limit;
      left -= segments_[i].width;
    }
    return y;
  }

  void cover(size_t first, int w, int top) {
    const int x = segments_[first].x, end = x + w;
    size_t last = first;
    while (last < segments_.size() && segments_[last].x + segments_[last].width <= end) ++last;
    if (last < segments_.size() && segments_[last].x < end) {
      segments_[last].width -= end - segments_[last].x;
      segments_[last].x = end;
    }
    segments_.erase(segments_.begin() + static_cast<ptrdiff_t>(first), segments_.begin() + static_cast<ptrdiff_t>(last));
    segments_.insert(segments_.begin() + static_cast<ptrdiff_t>(first), {x, top, w});
    if (first > 0 && segments_[first - 1].y == top) {
      segments_[first - 1].width += w;
      segments_.erase(segments_.begin() + static_cast<ptrdiff_t>(first));
      --first;
    }
    if (first + 1 < segments_.size() && segments_[first + 1].y == top) {
      segments_[first].width += segments_[first + 1].width;
      segments_.erase(segments_.begin() + static_cast<ptrdiff_t>(first) + 1);
    }
  }

  int width_, height_;
  std::vector<Segment> segments_;
};

struct Packer {
  const std::vector<glm::dvec2>& sizes;
  int resolution;
  std::vector<uint32_t> order;  ///< tallest first
  const Progress& progress;

  /// Number of rectangles placed, in order, until one did not fit.
  size_t pack(double scale, int margin, std::vector<Placement>* out) const {
    progress.check();
    Skyline skyline(resolution + margin, resolution + margin);
    for (size_t n = 0; n < order.size(); ++n) {
      const uint32_t i = order[n];
      const Extent w = extentOf(sizes[i].x, scale), h = extentOf(sizes[i].y, scale);
      ivec2 at;
      if (!skyline.place(w.cells + margin, h.cells + margin, at)) return n;
      if (out == nullptr) continue;
      const glm::dvec2 texels(w.texels - 2 * kInset, h.texels - 2 * kInset);
      const glm::dvec2 spare(w.cells - texels.x, h.cells - texels.y);
      Placement& p = (*out)[i];
      p.placed = true;
      p.cell = at;
      p.cellSize = {w.cells, h.cells};
      p.origin = glm::dvec2(at.x + 0.5 * spare.x, at.y + 0.5 * spare.y);
      p.scale = {sizes[i].x > 0 ? texels.x / sizes[i].x : 0.0, sizes[i].y > 0 ? texels.y / sizes[i].y : 0.0};
    }
    return order.size();
  }
  bool fits(double scale, int margin) const { return pack(scale, margin, nullptr) == order.size(); }

  /// The largest scale found by bisection, or 0 where not even the smallest fits.
  double largestScale(double limit, int margin) const {
    double low = limit * 1e-3, high = limit;
    if (!fits(low, margin)) return 0;
    if (fits(high, margin)) return high;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (low + high);
      (fits(middle, margin) ? low : high) = middle;
    }
    return low;
  }
};

}  // namespace

Packing packRectangles(const std::vector<glm::dvec2>& sizes, int resolution, int margin, Progress& progress) {
  Packing packing;
  packing.placements.resize(sizes.size());
  packing.margin = margin;
  if (sizes.empty()) return packing;

  Packer packer{sizes, resolution, std::vector<uint32_t>(sizes.size()), progress};
  std::iota(packer.order.begin(), packer.order.end(), 0u);
  std::sort(packer.order.begin(), packer.order.end(), [&](uint32_t a, uint32_t b) {
    if (sizes[a].y != sizes[b].y) return sizes[a].y > sizes[b].y;
    return sizes[a].x != sizes[b].x ? sizes[a].x > sizes[b].x : a < b;
  });
  double area = 0;
  for (glm::dvec2 s : sizes) area += s.x * s.y;
  // Rounding may make rectangles smaller than they are, by at most an eighth a side.
  const double limit = 1.15 * resolution / std::sqrt(std::max(area, 1e-300));

  const double tight = packer.largestScale(limit, 0);
  double scale = tight;
  packing.margin = 0;
  for (int m = margin; m > 0 && tight > 0; --m) {
    const double s = packer.largestScale(limit, m);
    if (s >= kMarginWorth * tight) {
      scale = s;
      packing.margin = m;
      break;
    }
  }
  if (scale == 0) scale = limit * 1e-3;
  packing.texelsPerMetre = scale;
  packer.pack(scale, packing.margin, &packing.placements);
  return packing;
}

}  // namespace hl
