#pragma once
// What metrics of appearance look at: the picture that a screen would show of scene-referred light.
#include <cmath>
#include <cstdint>

#include "shaders/shared/tone_map.h"

namespace hl {

/// Pixels a degree of a display 0.7 m wide, of 3840 pixels, seen from 0.7 m, as FLIP's authors take it.
inline constexpr float kPixelsPerDegree = 67.02f;

struct Appearance {
  float exposure = 0;                        ///< stops
  uint32_t curve = shared::kToneMapLinear;   ///< kToneMap... of shaders/shared/tone_map.h, then sRGB
  bool stored = false;                       ///< the images hold display values in [0, 1] (a PNG's) and not light: neither exposure nor curve
  float pixelsPerDegree = kPixelsPerDegree;  ///< at which FLIP's eye sees them
  bool operator==(const Appearance&) const = default;
};

/// From an image's values to what is seen of them.
class Screen {
 public:
  explicit Screen(const Appearance& a = {}) : scale_(a.stored ? 1.0f : std::exp2(a.exposure)), curve_(a.curve), stored_(a.stored) {}
  /// 2^exposure; 1 for stored pictures.
  float scale() const { return scale_; }
  /// What the screen gives off: linear, in [0, 1]. Of a finite value.
  float shown(float value) const {
    return stored_ ? shared::srgbDecode(shared::clamp(value, 0.0f, 1.0f)) : shared::toneMapped(value * scale_, curve_);
  }
  /// The same as the screen's signal, sRGB encoded.
  float signal(float value) const { return stored_ ? shared::clamp(value, 0.0f, 1.0f) : shared::displayValue(value * scale_, curve_); }

 private:
  float scale_;
  uint32_t curve_;
  bool stored_;
};

}  // namespace hl
