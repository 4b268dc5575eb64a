#include "ui/slider_scale.h"

#include <algorithm>
#include <cmath>

namespace hl::ui {
namespace {

constexpr int kFineSteps = 400;     // enough for a slider as wide as a screen's third
constexpr double kLogNotch = 1.2;   // factor of one notch on a logarithmic scale
constexpr double kLinearNotches = 50;

double rounded(double v, bool whole) {
  if (whole) return std::round(v);
  if (v == 0) return 0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(v))) - 2);
  // Dividing by the reciprocal keeps decimal values such as 0.05 exact.
  return unit < 1 ? std::round(v / unit) / std::round(1 / unit) : std::round(v / unit) * unit;
}

}  // namespace

SliderScale::SliderScale(const ParamInfo& p)
    : low_(p.softMin),
      high_(p.softMax),
      min_(p.min),
      max_(p.max),
      log_(p.scale == ParamScale::Log && p.softMin > 0),
      whole_(p.type == ParamType::Int) {
  const double span = high_ - low_;
  steps_ = whole_ && !log_ && span <= kFineSteps ? std::max(1, static_cast<int>(span)) : kFineSteps;
}

int SliderScale::position(double v) const {
  if (!(high_ > low_)) return 0;
  v = std::clamp(v, low_, high_);
  const double t = log_ ? std::log(v / low_) / std::log(high_ / low_) : (v - low_) / (high_ - low_);
  return static_cast<int>(std::lround(t * steps_));
}

double SliderScale::value(int position) const {
  const double t = static_cast<double>(position) / steps_;
  if (position <= 0) return low_;
  if (position >= steps_) return high_;
  const double v = log_ ? low_ * std::pow(high_ / low_, t) : low_ + t * (high_ - low_);
  return std::clamp(rounded(v, whole_), low_, high_);
}

double SliderScale::stepped(double v, int notches) const {
  double out = v;
  if (log_ && v > 0) {
    out = rounded(v * std::pow(kLogNotch, notches), whole_);
    if (whole_ && out == v) out = v + notches;
  } else {
    const double notch = whole_ ? std::max(1.0, std::round((high_ - low_) / 200)) : rounded((high_ - low_) / kLinearNotches, false);
    // Cleaned of the digits that repeated addition leaves.
    out = whole_ ? v + notches * notch : std::round((v + notches * notch) / notch * 1e6) / 1e6 * notch;
    if (!whole_) out = static_cast<double>(static_cast<float>(out));
  }
  return std::clamp(out, min_, max_);
}

}  // namespace hl::ui
