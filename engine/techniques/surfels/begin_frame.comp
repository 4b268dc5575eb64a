#version 460
#extension GL_GOOGLE_include_directive : require
// The last frame's sums make room for this one's.
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 1) in;

void main() {
  if (frame.frame == 0u) {
    totals.highWater = totals.freeCount = totals.alive = totals.priority = totals.young = 0u;
  }
  totals.lastPriority = totals.priority;
  totals.lastYoung = totals.young;
  totals.priority = 0u;
  totals.inView = totals.young = 0u;
  if (frame.listed != 0u) totals.entries = totals.largestCell = totals.largestTile = 0u;
  for (uint i = 0u; i < kSurfelCounters; ++i)
    if (frame.listed != 0u || (i != kCountCellOverflows && i != kCountDroppedLists)) totals.counters[i] = 0u;  // what the lists lack they lack until they are made anew
}
