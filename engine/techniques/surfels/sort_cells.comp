#version 460
#extension GL_GOOGLE_include_directive : require
// Each cell's list in the order of numbers, whichever invocation of "scatter" came first: sums over it then never differ, and a limit always
// leaves out the same.
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer cell_offsets { uint cellOffsets[]; };
layout(scalar) buffer cell_entries { uint cellEntries[]; };

void main() {
  const uint cell = gl_GlobalInvocationID.x;
  if (cell >= frame.lists) return;
  const uint first = cellOffsets[cell], count = cellOffsets[cell + 1u] - first;
  if (cell == frame.lists - 1u) totals.entries = first + count;
  if (count == 0u) return;
  if (first + count > frame.entriesMost) {
    countOne(kCountDroppedLists);
    return;
  }
  if (cell < frame.cells) {
    atomicMax(totals.largestCell, count);
    if (count > uint(surfels.cell_limit)) countOne(kCountCellOverflows);
  } else {
    atomicMax(totals.largestTile, count);
  }
  // Shell's sort, with Knuth's gaps.
  uint gap = 1u;
  while (gap < count / 3u) gap = 3u * gap + 1u;
  for (; gap > 0u; gap /= 3u)
    for (uint i = gap; i < count; ++i) {
      const uint value = cellEntries[first + i];
      uint j = i;
      while (j >= gap) {
        const uint other = cellEntries[first + j - gap];
        if (other <= value) break;
        cellEntries[first + j] = other;
        j -= gap;
      }
      if (j != i) cellEntries[first + j] = value;
    }
}
