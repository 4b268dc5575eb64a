#version 460
#extension GL_GOOGLE_include_directive : require
// Surfels into the lists of the cells they reach. Counts run down to zero and are ready for the next frame.
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer records_block { vec4 records[]; };
layout(scalar) readonly buffer cell_offsets { uint cellOffsets[]; };
layout(scalar) buffer cell_counts { uint cellCounts[]; };
layout(scalar) writeonly buffer cell_entries { uint cellEntries[]; };

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels) return;
  const vec4 place = records[kRecordTexels * id];
  if (place.w <= 0.0) return;
  ivec3 low, high;
  cellsOf(place.xyz, records[kRecordTexels * id + 1u].xyz, place.w, low, high);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const uint cell = cellIndex(ivec3(x, y, z));
        cellEntries[cellOffsets[cell] + atomicAdd(cellCounts[cell], 0xffffffffu) - 1u] = id;
      }
}
