#version 460
#extension GL_GOOGLE_include_directive : require
// Irradiance at pixels, and in alpha how well surfels cover them.
#define HL_SURFELS_LOOKUP
#define HL_SURFELS_STATES
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 2) const bool kSplat = false;  ///< pixels read the lists of their tiles
layout(constant_id = 1) const uint kStep = 1;  ///< pixels of the G-buffer a pixel of the result, along each side

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rgba32f) writeonly uniform image2D result;

Gathered gatherPixel(ivec2 pixel, vec3 p, vec3 n) {
  if (!kSplat) return gatherAt(p, n, false);
  const uint across = (frame.width + kSplatPixels - 1u) / kSplatPixels;
  uint first, end;
  if (!listOf(frame.cells + uint(pixel.y) / kSplatPixels * across + uint(pixel.x) / kSplatPixels, first, end)) return gatherAt(p, n, false);
  Gathered g = gatherFrom(p, n, false, first, end);
  if (g.weight <= 0.0 && surfels.fill_gaps != 0) {
    cellList(cellAt(p), first, end);
    fillGap(p, n, first, end, g);
  }
  return g;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  vec4 value = vec4(0.0);
  const ivec2 source = min(pixel * int(kStep), imageSize(position) - 1);
  const vec4 place = imageLoad(position, source);
  if (place.w != 0.0) {
    const Gathered g = gatherPixel(source, place.xyz, imageLoad(geometricNormal, source).xyz);
    value = vec4(g.irradiance, g.coverage);
    if (g.coverage <= 0.0) countOne(kCountUncoveredPixels);
    if (g.weight <= 0.0) countOne(kCountUnlitPixels);
    if (g.nearest != kNoSurfel && states[g.nearest].lastSeen != frame.frame) states[g.nearest].lastSeen = frame.frame;
  }
  imageStore(result, pixel, value);
}
