#include "engine/scene/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/image_io.h"

namespace hl {
namespace {

constexpr float kBelowOne = 0.99999994f;

/// Where in a cumulative list `u` falls, and how far into that share.
uint32_t choose(const float* cumulative, uint32_t count, float& u) {
  const auto at = static_cast<uint32_t>(std::min<ptrdiff_t>(std::upper_bound(cumulative, cumulative + count, u) - cumulative, count - 1));
  const float before = at == 0 ? 0.0f : cumulative[at - 1], share = cumulative[at] - before;
  u = share > 0 ? std::clamp((u - before) / share, 0.0f, kBelowOne) : 0.5f;
  return at;
}

}  // namespace

Environment loadEnvironment(const std::filesystem::path& file, uint64_t& negative) {
  const Image image = rgbOf(readImage(file));
  if (image.width < 1 || image.height < 1 || image.pixels() > kMostEnvironmentTexels)
    throw badInput(fmt::format("{}: an environment map of {} x {} texels; at most {} are taken (4096 x 2048): reduce it", file.string(), image.width, image.height,
                               kMostEnvironmentTexels));
  Environment e;
  e.file = file.string();
  e.width = image.width, e.height = image.height;
  e.radiance.resize(image.pixels());
  negative = 0;
  for (size_t i = 0; i < image.pixels(); ++i) {
    bool below = false;
    for (int c = 0; c < 3; ++c) {
      const float v = image.data[3 * i + static_cast<size_t>(c)];
      if (!std::isfinite(v))
        throw badInput(fmt::format("{}: texel ({}, {}) is {}; finite radiance is wanted", file.string(), i % static_cast<size_t>(image.width), i / static_cast<size_t>(image.width), v));
      below = below || v < 0;
      e.radiance[i][c] = std::max(v, 0.0f);
    }
    negative += below;
  }
  return e;
}

EnvironmentLight::EnvironmentLight(const Environment& e) {
  if (e.empty()) return;
  const auto width = static_cast<uint32_t>(e.width), height = static_cast<uint32_t>(e.height);
  radiance_.resize(e.radiance.size());
  for (size_t i = 0; i < radiance_.size(); ++i) radiance_[i] = e.radiance[i] * e.scale;
  std::vector<double> rows(height);
  double total = 0;
  constexpr double kTurn = 2 * 3.14159265358979323846;
  for (uint32_t y = 0; y < height; ++y) {
    // Exact solid angle of a texel of the row.
    const double texel = kTurn / width * (std::cos(0.5 * kTurn * y / height) - std::cos(0.5 * kTurn * (y + 1) / height));
    double sum = 0;
    for (uint32_t x = 0; x < width; ++x) sum += static_cast<double>(luminance(radiance_[size_t{y} * width + x]));
    rows[y] = sum * texel;
    total += rows[y];
  }
  info_ = {width, height, e.rotation / static_cast<float>(kTurn), static_cast<float>(total)};
  if (!(total > 0)) return;
  table_.resize(height + radiance_.size());
  double before = 0;
  for (uint32_t y = 0; y < height; ++y) {
    table_[y] = static_cast<float>((before += rows[y]) / total);
    double sum = 0, row = 0;
    for (uint32_t x = 0; x < width; ++x) row += static_cast<double>(luminance(radiance_[size_t{y} * width + x]));
    for (uint32_t x = 0; x < width; ++x) {
      sum += static_cast<double>(luminance(radiance_[size_t{y} * width + x]));
      table_[height + size_t{y} * width + x] = row > 0 ? static_cast<float>(sum / row) : static_cast<float>(x + 1) / static_cast<float>(width);
    }
  }
}

EnvironmentSample EnvironmentLight::sample(vec2 u) const {
  EnvironmentSample s;
  if (!shines()) return s;
  const uint32_t row = choose(table_.data(), info_.height, u.y);
  const uint32_t column = choose(table_.data() + info_.height + size_t{row} * info_.width, info_.width, u.x);
  s.direction = shared::environmentDirection(info_, column, row, u);
  s.radiance = radiance_[size_t{row} * info_.width + column];
  s.pdf = pdf(s.radiance);
  return s;
}

}  // namespace hl
