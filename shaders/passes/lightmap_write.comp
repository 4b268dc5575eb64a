#version 460
#extension GL_GOOGLE_include_directive : require
// Lumels into the lightmap's image. Alpha is 1 where a texel has its own, else 0.
#include "shaders/shared/lightmap_codes.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kSums = false;  ///< values are sums with their number of samples in w
layout(constant_id = 1) const uint kChannel = 0u;   ///< of values that have four a lumel: all lumels' first ones, then the second ones ...

layout(scalar) readonly buffer lumelOfTexel_block { uint lumelOfTexel[]; };
layout(scalar) readonly buffer values_block { vec4 values[]; };
layout(rgba32f) writeonly uniform image2D lightmap;

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(lightmap);
  if (any(greaterThanEqual(texel, size))) return;
  uint lumel = lumelOfTexel[uint(texel.y * size.x + texel.x)];
  vec4 result = vec4(0.0);
  if ((lumel & kBorrowed) == 0u) {
    vec4 v = values[kChannel * (uint(values.length()) / 4u) + lumel];
    result = vec4(kSums ? (v.w > 0.0 ? v.xyz / v.w : vec3(0.0)) : v.xyz, 1.0);
  }
  imageStore(lightmap, texel, result);
}
