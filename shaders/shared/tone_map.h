#ifndef HALFLIGHT_TONE_MAP_H
#define HALFLIGHT_TONE_MAP_H
// From scene-referred radiance to display values, the same on the host and on the device.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST uint kToneMapLinear = 0u;
HL_CONST uint kToneMapAces = 1u;
HL_CONST uint kToneMapReinhard = 2u;

/// Rational fit to the ACES filmic curve: Narkowicz, "ACES Filmic Tone Mapping Curve", 2015.
HL_INLINE float acesCurve(float x) { return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f); }

/// Reinhard et al., "Photographic Tone Reproduction for Digital Images", 2002, equation 3, by channel.
HL_INLINE float reinhardCurve(float x) { return x / (1.0f + x); }

/// IEC 61966-2-1, of a value in [0, 1].
HL_INLINE float srgbEncode(float x) { return x <= 0.0031308f ? 12.92f * x : 1.055f * pow(x, 1.0f / 2.4f) - 0.055f; }

/// Undoes srgbEncode.
HL_INLINE float srgbDecode(float x) { return x <= 0.04045f ? x / 12.92f : pow((x + 0.055f) / 1.055f, 2.4f); }

/// A finite value after exposure, to what a screen gives off: linear, in [0, 1].
HL_INLINE float toneMapped(float x, uint curve) {
  float y = max(x, 0.0f);
  // The curves' own quotients overflow long before a float does; there they have reached their limit.
  y = min(y, 1e9f);
  if (curve == kToneMapAces) y = acesCurve(y);
  if (curve == kToneMapReinhard) y = reinhardCurve(y);
  return clamp(y, 0.0f, 1.0f);
}

/// ... and to the signal that makes a screen do so.
HL_INLINE float displayValue(float x, uint curve) { return srgbEncode(toneMapped(x, curve)); }

// Where something is wrong with a pixel, in display values.
#ifdef __cplusplus
inline const vec3 kNanColour(1, 0, 1), kInfiniteColour(1, 1, 0), kNegativeColour(0, 1, 1);
#else
const vec3 kNanColour = vec3(1, 0, 1), kInfiniteColour = vec3(1, 1, 0), kNegativeColour = vec3(0, 1, 1);
#endif

HL_INLINE bool isNonFinite(float x) { return (floatBitsToUint(x) & 0x7f800000u) == 0x7f800000u; }
HL_INLINE bool isNanBits(float x) { return (floatBitsToUint(x) & 0x7fffffffu) > 0x7f800000u; }

HL_END
#endif
