#include "engine/metrics/temporal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/math.h"

namespace hl {

namespace {

constexpr double kRelativeEpsilon = 0.01;

double luminanceAt(const Image& image, size_t pixel) {
  const float* p = image.data.data() + pixel * static_cast<size_t>(image.channels);
  return static_cast<double>(image.channels >= 3 ? luminance(vec3(p[0], p[1], p[2])) : p[0]);
}

bool counts(const Mask& mask, size_t pixel) { return mask.empty() || mask[pixel] != 0; }

void requireMaskOf(const Mask& mask, size_t pixels) {
  if (!mask.empty() && mask.size() != pixels) throw badInput(fmt::format("the mask has {} pixels, the frames {}", mask.size(), pixels));
}

/// The first index from 1 on from which every entry is at most `limit`.
std::optional<uint64_t> settledAt(const std::vector<double>& left, double limit) {
  size_t at = left.size();
  while (at > 0 && left[at - 1] <= limit) --at;
  return at < left.size() ? std::optional<uint64_t>(at + 1) : std::nullopt;
}

}  // namespace

void FlickerMeter::add(const Image& frame) {
  if (frame.channels == 2 || frame.pixels() == 0) throw badInput("flicker: a frame with one channel or with three is wanted");
  if (frames_ == 0) {
    width_ = frame.width, height_ = frame.height;
    mean_.assign(frame.pixels(), 0.0), squares_.assign(frame.pixels(), 0.0);
  }
  if (frame.width != width_ || frame.height != height_)
    throw badInput(fmt::format("flicker: a frame of {} x {} pixels after one of {} x {}", frame.width, frame.height, width_, height_));
  ++frames_;
  for (size_t i = 0; i < mean_.size(); ++i) {
    const double light = luminanceAt(frame, i), off = light - mean_[i];
    mean_[i] += off / static_cast<double>(frames_);
    squares_[i] += off * (light - mean_[i]);
  }
}

FlickerResult FlickerMeter::result(const Mask& mask) const {
  if (frames_ < 2) throw badInput(fmt::format("flicker: at least two frames are wanted, there were {}", frames_));
  requireMaskOf(mask, mean_.size());
  FlickerResult r;
  r.map = Image(width_, height_, 1);
  double light = 0;
  uint64_t pixels = 0;
  for (size_t i = 0; i < mean_.size(); ++i) {
    if (!counts(mask, i)) continue;
    ++pixels, light += mean_[i];
    if (!std::isfinite(mean_[i]) || !std::isfinite(squares_[i])) ++r.nonFinite;
  }
  if (pixels == 0) throw badInput("flicker: no pixel counts");
  r.epsilon = kRelativeEpsilon * light / static_cast<double>(pixels);
  double sum = 0;
  for (size_t i = 0; i < mean_.size(); ++i) {
    if (!counts(mask, i)) continue;
    const double deviation = std::sqrt(squares_[i] / static_cast<double>(frames_ - 1));
    // What never changes does not flicker, be it black.
    const double term = deviation == 0 ? 0 : deviation / (mean_[i] + r.epsilon);
    r.map.data[i] = static_cast<float>(term);
    sum += term;
  }
  r.value = r.nonFinite > 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(pixels);
  return r;
}

TransientMeter::TransientMeter(Image before, Image after, Mask mask) : after_(std::move(after)), mask_(std::move(mask)) {
  requireMaskOf(mask_, after_.pixels());
  const Difference step = difference(before, after_);
  response_.size = step.rms, meanStep_ = std::abs(step.mean);
  if (!std::isfinite(response_.size)) throw badInput("step response: the picture before or after the step is not finite");
  if (response_.size == 0) throw badInput("step response: the step changes nothing in the picture");
}

TransientMeter::Difference TransientMeter::difference(const Image& a, const Image& b) const {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw badInput(fmt::format("step response: images of {} x {} pixels with {} channels and of {} x {} with {}", a.width, a.height, a.channels, b.width, b.height,
                               b.channels));
  const size_t stride = static_cast<size_t>(a.channels), used = std::min<size_t>(stride, 3);
  double sum = 0, mean = 0;
  uint64_t values = 0;
  for (size_t i = 0; i < a.pixels(); ++i) {
    if (!counts(mask_, i)) continue;
    for (size_t c = 0; c < used; ++c) {
      const double off = static_cast<double>(a.data[i * stride + c]) - static_cast<double>(b.data[i * stride + c]);
      sum += off * off, mean += off, ++values;
    }
  }
  if (values == 0) return {};
  return {std::sqrt(sum / static_cast<double>(values)), mean / static_cast<double>(values)};
}

double TransientMeter::add(const Image& frame) {
  const Difference off = difference(frame, after_);
  const double left = off.rms / response_.size;
  if (!std::isfinite(left)) throw Error(ErrorKind::Run, fmt::format("step response: frame {} is not finite", response_.left.size() + 1));
  response_.left.push_back(left);
  response_.meanLeft.push_back(meanStep_ > 0 ? std::abs(off.mean) / meanStep_ : left);
  return left;
}

double TransientMeter::leftBy(const Image& settled) const {
  const double left = difference(settled, after_).rms / response_.size;
  if (!std::isfinite(left)) throw Error(ErrorKind::Run, "step response: a frame of the settled picture is not finite");
  return left;
}

StepResponse TransientMeter::result() const {
  StepResponse r = response_;
  r.frames5 = settledAt(r.left, 0.05), r.frames1 = settledAt(r.left, 0.01);
  r.meanFrames5 = settledAt(r.meanLeft, 0.05), r.meanFrames1 = settledAt(r.meanLeft, 0.01);
  return r;
}

}  // namespace hl
