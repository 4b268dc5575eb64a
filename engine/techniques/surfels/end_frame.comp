#version 460
#extension GL_GOOGLE_include_directive : require
// How many numbers were taken and given back.
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 1) in;

layout(scalar) readonly buffer placed_order { uint placedOrder[]; };

void main() {
  const uint placed = frame.places == 0u ? 0u : placedOrder[frame.candidates];
  const uint reused = min(placed, totals.freeCount);
  const uint fresh = min(placed - reused, frame.maxSurfels - totals.highWater);
  const uint recycled = totals.counters[kCountRecycled];
  totals.freeCount = totals.freeCount - reused + recycled;
  totals.highWater += fresh;
  totals.alive = totals.alive + reused + fresh - recycled;
  totals.stamp = frame.frame + 1u;
}
