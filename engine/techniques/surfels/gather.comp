#version 460
#extension GL_GOOGLE_include_directive : require
// Irradiance at pixels, and in alpha how well surfels cover them.
#define HL_SURFELS_LOOKUP
#define HL_SURFELS_STATES
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rgba32f) writeonly uniform image2D result;

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  vec4 value = vec4(0.0);
  const vec4 place = imageLoad(position, pixel);
  if (place.w != 0.0) {
    const Gathered g = gatherAt(place.xyz, imageLoad(geometricNormal, pixel).xyz);
    value = vec4(g.irradiance, g.coverage);
    if (!(g.weight > 0.0)) countOne(kCountUncoveredPixels);
    if (g.nearest != kNoSurfel && states[g.nearest].lastSeen != frame.frame) states[g.nearest].lastSeen = frame.frame;
  }
  imageStore(result, pixel, value);
}
