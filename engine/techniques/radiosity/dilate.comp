#version 460
#extension GL_GOOGLE_include_directive : require
// One ring further: a texel without a value takes the mean of its neighbours that have one, from the same chart where it is next to one alone.
#include "engine/techniques/radiosity/unit.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar) readonly buffer chartOfTexel_block { uint chartOfTexel[]; };
layout(rgba32f) readonly uniform image2D from;
layout(rgba32f) writeonly uniform image2D to;

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(from);
  if (any(greaterThanEqual(texel, size))) return;
  vec4 own = imageLoad(from, texel);
  uint chart = chartOfTexel[uint(texel.y * size.x + texel.x)];
  if (own.w == 0.0 && chart != kNoChart) {
    vec4 sum = vec4(0.0);
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        ivec2 at = texel + ivec2(x, y);
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
        vec4 v = imageLoad(from, at);
        bool same = chart == kMixedChart || chartOfTexel[uint(at.y * size.x + at.x)] == chart;
        if (v.w > 0.0 && same) sum += vec4(v.xyz, 1.0);
      }
    }
    if (sum.w > 0.0) own = vec4(sum.xyz / sum.w, 1.0);
  }
  imageStore(to, texel, own);
}
