#version 460
#extension GL_GOOGLE_include_directive : require
// One ring further, from neighbours that have a value, of the same chart where the texel is next to one alone. The first ring carries on the slope of
// the two texels behind each neighbour: pixels between a chart's last texel centres and its rim read it, and along contact lines light falls off steeply
// there. Cut off at nothing, it keeps a pixel within half to one and a half of the last texel. Further rings take the mean.
#include "shaders/shared/lightmap_codes.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kFirstRing = false;
layout(constant_id = 1) const bool kBelowZero = false;  ///< values may be negative

layout(scalar) readonly buffer chartOfTexel_block { uint chartOfTexel[]; };
layout(rgba32f) readonly uniform image2D from;
layout(rgba32f) writeonly uniform image2D to;

/// A texel's value where it has one that may be mixed with `chart`'s, else 0; w tells.
vec4 valueAt(ivec2 at, ivec2 size, uint chart) {
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) return vec4(0.0);
  bool same = chart == kMixedChart || chartOfTexel[uint(at.y * size.x + at.x)] == chart;
  return same ? imageLoad(from, at) : vec4(0.0);
}

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(from);
  if (any(greaterThanEqual(texel, size))) return;
  vec4 own = imageLoad(from, texel);
  uint chart = chartOfTexel[uint(texel.y * size.x + texel.x)];
  if (own.w == 0.0 && chart != kNoChart) {
    vec4 sum = vec4(0.0);
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        ivec2 step = ivec2(x, y);
        vec4 v = valueAt(texel + step, size, chart);
        if (step == ivec2(0) || v.w == 0.0) continue;
        if (kFirstRing && chart != kMixedChart) {
          vec4 behind = valueAt(texel + 2 * step, size, chart);
          if (behind.w > 0.0) v.xyz = kBelowZero ? 2.0 * v.xyz - behind.xyz : max(2.0 * v.xyz - behind.xyz, vec3(0.0));
        }
        sum += vec4(v.xyz, 1.0);
      }
    }
    if (sum.w > 0.0) own = vec4(sum.xyz / sum.w, 1.0);
  }
  imageStore(to, texel, own);
}
