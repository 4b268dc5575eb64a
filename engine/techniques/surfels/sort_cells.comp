#version 460
#extension GL_GOOGLE_include_directive : require
// Each list in the order of numbers, whichever invocation of "scatter" came first: sums over it then never differ, and a limit always leaves out the same.
// A work group takes kListsOfGroup lists: those of at most kAlone entries each by an invocation of its own, longer ones one after the other by all together.
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 128) in;
layout(constant_id = 11) const uint kListsOfGroup = 16u;  ///< at most as many as invocations
layout(constant_id = 12) const uint kAlone = 8u;

layout(scalar) readonly buffer cell_offsets { uint cellOffsets[]; };
layout(scalar) coherent buffer cell_entries { uint cellEntries[]; };

const uint kGroup = 128u;
const uint kHeld = 2048u;  ///< entries in shared memory: 8 KiB

shared uint longest;
shared uint held[kHeld];

/// Entries of a list that there was room for.
uint countOf(uint first, uint list) {
  const uint end = cellOffsets[list + 1u];
  return end > frame.entriesMost ? 0u : end - first;
}

void noteList(uint list, uint first) {
  const uint count = cellOffsets[list + 1u] - first;
  if (list == frame.lists - 1u) totals.entries = first + count;
  if (count == 0u) return;
  if (first + count > frame.entriesMost) {
    countOne(kCountDroppedLists);
  } else if (list < frame.cells) {
    atomicMax(totals.largestCell, count);
    if (count > uint(surfels.cell_limit)) countOne(kCountCellOverflows);
  } else {
    atomicMax(totals.largestTile, count);
  }
}

/// Shell's sort, with Knuth's gaps: little work where the list is nearly in order.
void sortAlone(uint first, uint count) {
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

uint entry(uint first, uint i, bool here) { return here ? held[i] : cellEntries[first + i]; }
void setEntry(uint first, uint i, bool here, uint value) {
  if (here) held[i] = value;
  else cellEntries[first + i] = value;
}

/// One step's pairs, the smaller to the front: across each block of 2 `reach` entries, mirrored or shifted.
void exchange(uint first, uint count, bool here, uint reach, bool mirrored) {
  for (uint k = gl_LocalInvocationIndex;; k += kGroup) {
    const uint within = k % reach, block = k / reach * 2u * reach;
    const uint low = block + within, high = block + (mirrored ? 2u * reach - 1u - within : within + reach);
    if (low >= count) break;
    if (high >= count) continue;
    const uint a = entry(first, low, here), b = entry(first, high, here);
    if (a <= b) continue;
    setEntry(first, low, here, b);
    setEntry(first, high, here, a);
  }
  if (!here) memoryBarrierBuffer();
  barrier();
}

/// Batcher's bitonic network (1968), merges beginning with a mirrored step: what lies beyond the list's end counts as largest and stays there. In shared memory
/// where the list fits, else where it lies. No assumption on subgroups.
void sortTogether(uint first, uint count) {
  const bool here = count <= kHeld;
  if (here)
    for (uint i = gl_LocalInvocationIndex; i < count; i += kGroup) held[i] = cellEntries[first + i];
  barrier();
  for (uint merged = 1u; merged < count; merged *= 2u) {
    exchange(first, count, here, merged, true);
    for (uint reach = merged / 2u; reach > 0u; reach /= 2u) exchange(first, count, here, reach, false);
  }
  if (here)
    for (uint i = gl_LocalInvocationIndex; i < count; i += kGroup) cellEntries[first + i] = held[i];
  barrier();
}

void main() {
  if (gl_LocalInvocationIndex == 0u) longest = 0u;
  barrier();
  const uint from = gl_WorkGroupID.x * kListsOfGroup, end = min(from + kListsOfGroup, frame.lists), own = from + gl_LocalInvocationIndex;
  if (own < end) {
    const uint first = cellOffsets[own], count = countOf(first, own);
    noteList(own, first);
    if (count <= kAlone) sortAlone(first, count);
    else atomicMax(longest, count);
  }
  barrier();
  if (longest <= kAlone) return;
  for (uint list = from; list < end; ++list) {
    const uint first = cellOffsets[list], count = countOf(first, list);
    if (count > kAlone) sortTogether(first, count);
  }
}
