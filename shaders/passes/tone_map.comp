#version 460
#extension GL_GOOGLE_include_directive : require
// Display values of an image, stretched to the frame texel by texel (no filter, so that a bad texel stays one and is seen).
#include "shaders/shared/tone_map.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint kChannels = 4;
layout(constant_id = 1) const uint kMode = 0;  ///< what the values are: see engine/passes/display.cpp
const uint kRadiance = 0, kColour = 1, kDirection = 2, kPlace = 3, kShift = 4;
/// Pixels of motion that show as full colour.
const float kFullShift = 16.0;

uniform sampler2D source;
layout(rgba8) writeonly uniform image2D display;
layout(scalar) buffer counters_block { uint counters[]; };  // pixels not finite, pixels negative
layout(push_constant, scalar) uniform Constants {
  float scale;  ///< 2 to the exposure
  uint curve;
  uint showInvalid;
};

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy), size = imageSize(display);
  if (any(greaterThanEqual(p, size))) return;
  const ivec2 from = min(p * textureSize(source, 0) / size, textureSize(source, 0) - 1);
  const vec4 texel = texelFetch(source, from, 0);
  vec3 c = kChannels == 1 ? texel.rrr : kChannels == 2 ? vec3(texel.rg, 0.0) : texel.rgb;

  const bool nan = isNanBits(c.r) || isNanBits(c.g) || isNanBits(c.b);
  const bool nonFinite = isNonFinite(c.r) || isNonFinite(c.g) || isNonFinite(c.b);
  const bool negative = kMode <= kColour && !nonFinite && (c.r < 0.0 || c.g < 0.0 || c.b < 0.0);
  if (nonFinite) atomicAdd(counters[0], 1u);
  if (negative) atomicAdd(counters[1], 1u);

  vec3 shown;
  if (nonFinite) {
    for (int i = 0; i < 3; ++i) shown[i] = isNonFinite(c[i]) && !isNanBits(c[i]) && c[i] > 0.0 ? 1.0 : 0.0;
  } else if (kMode == kDirection) {
    shown = dot(c, c) > 0.0 ? 0.5 * c + 0.5 : vec3(0.0);
  } else if (kMode == kPlace) {
    shown = fract(c);
  } else if (kMode == kShift) {
    shown = vec3(clamp(0.5 + 0.5 * c.rg / kFullShift, 0.0, 1.0), 0.5);
  } else {
    const float factor = kMode == kRadiance ? scale : 1.0;
    const uint used = kMode == kRadiance ? curve : kToneMapLinear;
    for (int i = 0; i < 3; ++i) shown[i] = displayValue(c[i] * factor, used);
  }
  if (showInvalid != 0u) {
    if (negative) shown = kNegativeColour;
    if (nonFinite) shown = nan ? kNanColour : kInfiniteColour;
  }
  imageStore(display, p, vec4(shown, 1.0));
}
