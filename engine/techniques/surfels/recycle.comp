#version 460
#extension GL_GOOGLE_include_directive : require
// Numbers of surfels that go, onto the stack of free ones, in their order, above what placing left there.
#define HL_SURFELS_STATES
#define HL_SURFELS_RECORDS
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer flags_block { uint flags[]; };
layout(scalar) readonly buffer order_block { uint order[]; };
layout(scalar) readonly buffer placed_order { uint placedOrder[]; };
layout(scalar) writeonly buffer free_ids { uint freeIds[]; };

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels || flags[id] == 0u) return;
  const uint left = totals.freeCount - min(placedOrder[frame.candidates], totals.freeCount);
  freeIds[left + order[id]] = id;
  atomicAdd(totals.priority, 0u - (states[id].priority & kPriorityMask));
  atomicAdd(totals.young, 0u - (states[id].priority >> 16u));
  states[id].priority = 0u;
  records[kRecordTexels * id].w = 0.0;
  records[kRecordTexels * id + 1u].w = 0.0;
  countOne(kCountRecycled);
}
