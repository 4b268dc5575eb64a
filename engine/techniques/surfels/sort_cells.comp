#version 460
#extension GL_GOOGLE_include_directive : require
// Each list in the order of numbers, whichever invocation of "scatter" came first: sums over it then never differ, and a limit always leaves out the same.
// A work group takes kListsOfGroup lists: those of at most kAlone entries each by an invocation of its own; those of at most kRanked all at once, each entry by
// counting the smaller ones in its list; longer ones one after the other by all invocations together.
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 128) in;
layout(constant_id = 11) const uint kListsOfGroup = 16u;  ///< at most as many as invocations
layout(constant_id = 12) const uint kAlone = 8u;
layout(constant_id = 13) const uint kRanked = 512u;           ///< at most kHeld

layout(scalar) readonly buffer cell_offsets { uint cellOffsets[]; };
layout(scalar) coherent buffer cell_entries { uint cellEntries[]; };

const uint kGroup = 128u;
const uint kHeld = 2048u;  ///< entries in shared memory: 8 KiB

shared uint longest, largestCell;
shared uint held[kHeld];
shared uint offsets[kGroup + 1u];  ///< of the group's lists

/// Entries of the group's k-th list that there was room for.
uint countOf(uint k) { return offsets[k + 1u] > frame.entriesMost ? 0u : offsets[k + 1u] - offsets[k]; }

void noteList(uint list, uint first, uint count) {
  if (list == frame.lists - 1u) totals.entries = first + count;
  if (count == 0u) return;
  if (first + count > frame.entriesMost) {
    countOne(kCountDroppedLists);
  } else if (list < frame.cells) {
    atomicMax(largestCell, count);
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

/// Lists [from, end) of the group, which held has room for: an entry's place is the number of those before it.
void sortRanked(uint from, uint end) {
  const uint first = offsets[from], most = min(offsets[end], frame.entriesMost);
  for (uint i = first + gl_LocalInvocationIndex; i < most; i += kGroup) held[i - first] = cellEntries[i];
  barrier();
  for (uint i = first + gl_LocalInvocationIndex; i < most; i += kGroup) {
    uint list = from, high = end;  // the last list that begins here or before
    while (high - list > 1u) {
      const uint middle = (list + high) / 2u;
      if (offsets[middle] <= i) list = middle; else high = middle;
    }
    const uint count = countOf(list), begin = offsets[list] - first;
    if (count <= kAlone || count > kRanked) continue;
    const uint value = held[i - first];
    uint rank = 0u;
    for (uint k = begin; k < begin + count; ++k) rank += held[k] < value || (held[k] == value && k < i - first) ? 1u : 0u;
    cellEntries[first + begin + rank] = value;
  }
  barrier();
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
  const uint from = gl_WorkGroupID.x * kListsOfGroup, lists = min(kListsOfGroup, frame.lists - from), own = gl_LocalInvocationIndex;
  if (own == 0u) longest = largestCell = 0u;
  for (uint k = own; k <= lists; k += kGroup) offsets[k] = cellOffsets[from + k];
  barrier();
  if (offsets[0] == offsets[lists] && from + lists < frame.lists) return;
  if (own < lists) {
    noteList(from + own, offsets[own], offsets[own + 1u] - offsets[own]);
    const uint count = countOf(own);
    if (count <= kAlone) sortAlone(offsets[own], count);
    else atomicMax(longest, count);
  }
  barrier();
  if (own == 0u && largestCell > 0u) atomicMax(totals.largestCell, largestCell);
  if (longest <= kAlone) return;
  for (uint begin = 0u, end; kRanked > kAlone && begin < lists; begin = end) {
    end = begin + 1u;
    if (offsets[begin + 1u] - offsets[begin] > kHeld) continue;
    while (end < lists && offsets[end + 1u] - offsets[begin] <= kHeld) ++end;
    sortRanked(begin, end);
  }
  if (longest <= kRanked) return;
  for (uint k = 0u; k < lists; ++k)
    if (countOf(k) > max(kAlone, kRanked)) sortTogether(offsets[k], countOf(k));
}
