#version 460
#extension GL_GOOGLE_include_directive : require
// Surfels into the lists of the cells they reach and the tiles they may light, the first to come in front: where work groups run in their order, lists are nearly
// sorted then. Counts run down to zero and are ready for the next frame.
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer records_block { vec4 records[]; };
layout(scalar) readonly buffer cell_offsets { uint cellOffsets[]; };
layout(scalar) buffer cell_counts { uint cellCounts[]; };
layout(scalar) writeonly buffer cell_entries { uint cellEntries[]; };

void visit(uint list, uint id) {
  const uint slot = cellOffsets[list + 1u] - atomicAdd(cellCounts[list], 0xffffffffu);
  if (slot < frame.entriesMost) cellEntries[slot] = id;
}
#include "engine/techniques/surfels/lists.glsl"

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels) return;
  const vec4 place = records[kRecordTexels * id];
  if (place.w == 0.0) return;
  visitLists(place.xyz, records[kRecordTexels * id + 1u].xyz, place.w, id);
}
