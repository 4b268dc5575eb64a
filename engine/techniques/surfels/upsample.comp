#version 460
#extension GL_GOOGLE_include_directive : require
// From half the resolution to the whole: the nearest four that lie on the same surface, by bilinear weights; where none does, a look-up of its own.
#define HL_SURFELS_LOOKUP
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rgba32f) readonly uniform image2D halved;
layout(rgba32f) writeonly uniform image2D result;

const float kSameNormal = 0.95;      ///< least cosine
const float kSamePlane = 1.0;        ///< largest distance from the pixel's plane, in pixels there
const float kEnough = 0.2;           ///< least sum of weights

void add(ivec2 tap, float bilinear, vec3 p, vec3 n, float footprint, inout vec4 sum, inout float weight) {
  if (bilinear <= 0.0 || any(greaterThanEqual(tap, imageSize(halved)))) return;
  const ivec2 source = min(tap * 2, imageSize(position) - 1);
  const vec4 place = imageLoad(position, source);
  if (place.w == 0.0 || dot(n, imageLoad(geometricNormal, source).xyz) < kSameNormal) return;
  if (abs(dot(n, place.xyz - p)) > kSamePlane * footprint) return;
  sum += bilinear * imageLoad(halved, tap);
  weight += bilinear;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  vec4 value = vec4(0.0);
  const vec4 place = imageLoad(position, pixel);
  if (place.w != 0.0) {
    const vec3 n = imageLoad(geometricNormal, pixel).xyz;
    const float footprint = frame.pixelAngle * distance(place.xyz, frame.eye);
    const ivec2 low = pixel / 2;
    const vec2 f = 0.5 * vec2(pixel - 2 * low);
    vec4 sum = vec4(0.0);
    float weight = 0.0;
    add(low, (1.0 - f.x) * (1.0 - f.y), place.xyz, n, footprint, sum, weight);
    add(low + ivec2(1, 0), f.x * (1.0 - f.y), place.xyz, n, footprint, sum, weight);
    add(low + ivec2(0, 1), (1.0 - f.x) * f.y, place.xyz, n, footprint, sum, weight);
    add(low + ivec2(1, 1), f.x * f.y, place.xyz, n, footprint, sum, weight);
    if (weight >= kEnough) {
      value = sum / weight;
    } else {
      const Gathered g = gatherAt(place.xyz, n, false);
      value = vec4(g.irradiance, g.coverage);
      if (g.coverage <= 0.0) countOne(kCountUncoveredPixels);
      if (g.weight <= 0.0) countOne(kCountUnlitPixels);
      countOne(kCountUpsampleMisses);
    }
  }
  imageStore(result, pixel, value);
}
