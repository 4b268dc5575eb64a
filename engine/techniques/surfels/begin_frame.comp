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
  // Without surfels no lists are made, so no lists of the past count either.
  bool anew = frame.listed != 0u || frame.surfels == 0u;
  if (frame.casts != 0u) {
    totals.lastPriority = totals.priority;
    totals.lastYoung = totals.young;
    totals.priority = 0u;
    totals.inView = totals.young = 0u;
  }
  if (anew) totals.entries = totals.largestCell = totals.largestTile = 0u;
  // What lists and pixels lack they lack until they are made anew.
  for (uint i = 0u; i < kSurfelCounters; ++i) {
    const bool ofLists = i == kCountCellOverflows || i == kCountDroppedLists, ofPixels = i == kCountUncoveredPixels || i == kCountUnlitPixels;
    if ((anew || !ofLists) && (frame.gathers != 0u || !ofPixels)) totals.counters[i] = 0u;
  }
}
