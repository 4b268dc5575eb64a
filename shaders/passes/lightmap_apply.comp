#version 460
#extension GL_GOOGLE_include_directive : require
// The lightmap at pixels. Texels of other charts are left out and the weights of the rest scaled up, so nothing leaks across seams.
#include "shaders/shared/lightmap_codes.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kNearest = false;
layout(constant_id = 1) const bool kChecker = false;  ///< every second texel dimmed
layout(constant_id = 2) const bool kMapped = false;   ///< for the mapped normal n: the lightmap's value + slopes . n
layout(constant_id = 3) const bool kClampNegative = false;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D normal;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rg32ui) readonly uniform uimage2D ids;
layout(scalar) readonly buffer chartOfTriangle_block { uint chartOfTriangle[]; };
layout(scalar) readonly buffer chartOfTexel_block { uint chartOfTexel[]; };
layout(rgba32f) readonly uniform image2D lightmap;
layout(rgba32f) readonly uniform image2D slopesRed;
layout(rgba32f) readonly uniform image2D slopesGreen;
layout(rgba32f) readonly uniform image2D slopesBlue;
layout(rgba32f) writeonly uniform image2D result;
layout(scalar) buffer pixelCounters_block { uint pixelCounters[]; };  // pixels without a texel

mat3 slopes = mat3(0.0);  ///< sums like the values: a column a channel

void add(ivec2 texel, float weight, uint chart, inout vec4 sum) {
  ivec2 size = imageSize(lightmap);
  if (weight <= 0.0 || any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) return;
  if (chartOfTexel[uint(texel.y * size.x + texel.x)] != chart) return;
  vec4 v = imageLoad(lightmap, texel);
  if (v.w <= 0.0) return;
  sum += weight * vec4(v.xyz, 1.0);
  if (kMapped) slopes += weight * mat3(imageLoad(slopesRed, texel).xyz, imageLoad(slopesGreen, texel).xyz, imageLoad(slopesBlue, texel).xyz);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  vec4 value = vec4(0.0);
  if (imageLoad(position, pixel).w > 0.0) {
    uint chart = chartOfTriangle[imageLoad(ids, pixel).x - 1u];
    vec2 p = vec2(imageLoad(normal, pixel).w, imageLoad(geometricNormal, pixel).w) * vec2(imageSize(lightmap));
    vec4 sum = vec4(0.0);
    if (kNearest) add(ivec2(floor(p)), 1.0, chart, sum);
    if (sum.w == 0.0) {
      ivec2 low = ivec2(floor(p - 0.5));
      vec2 f = p - 0.5 - vec2(low);
      add(low, (1.0 - f.x) * (1.0 - f.y), chart, sum);
      add(low + ivec2(1, 0), f.x * (1.0 - f.y), chart, sum);
      add(low + ivec2(0, 1), (1.0 - f.x) * f.y, chart, sum);
      add(low + ivec2(1, 1), f.x * f.y, chart, sum);
    }
    // slopes' columns are channels, so a row vector times it has one product a channel.
    if (kMapped) sum.xyz += imageLoad(normal, pixel).xyz * slopes;
    if (kClampNegative) sum.xyz = max(sum.xyz, vec3(0.0));
    if (sum.w > 0.0) value = vec4(sum.xyz / sum.w, 1.0);
    else if (!kChecker) atomicAdd(pixelCounters[0], 1u);
    ivec2 texel = ivec2(floor(p));
    if (kChecker && ((texel.x ^ texel.y) & 1) == 1) value.xyz *= 0.5;
  }
  imageStore(result, pixel, value);
}
