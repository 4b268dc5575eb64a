#version 460
#extension GL_GOOGLE_include_directive : require
// Which surfels go: those that nothing has looked at for long when memory runs low, and those that the others cover well enough.
#define HL_SURFELS_LOOKUP
#define HL_SURFELS_STATES
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) writeonly buffer flags_block { uint flags[]; };

bool goes(uint id, SurfelState s) {
  // Drawn for neighbouring numbers together first: a look-up for one of them costs as much as for all.
  const float gate = min(1.0, 2.0 * surfels.recycle_chance);
  Random ofGroup = randomInit(frame.seed ^ 0x9e0ca5edu, gl_WorkGroupID.x, frame.frame);
  if (randomFloat(ofGroup) >= gate) return false;
  Random random = randomInit(frame.seed ^ 0x0ec1c1edu, id, frame.frame);
  const float luck = gate * randomFloat(random);
  if (luck >= surfels.recycle_chance) return false;
  const vec4 place = texelFetch(records, int(kRecordTexels * id));
  const uint idle = min(frame.frame - s.lastSeen, frame.frame - s.lastUsed);
  // The farther from the eye, the sooner; at the scene's diagonal for certain.
  if (frame.fill > surfels.recycle_fill && idle > uint(surfels.recycle_frames) + frame.recent - kRecentFrames)
    return luck < surfels.recycle_chance * min(1.0, 0.25 + distance(place.xyz, frame.eye) / frame.diagonal);
  // Only those that know their light count as covering: what has learnt does not make room for what has not.
  const vec4 normal = texelFetch(records, int(kRecordTexels * id + 1u));
  const bool seen = seenLately(s.lastSeen);
  const Gathered g = gatherAt(place.xyz, normal.xyz, !seen);
  return g.weight - normal.w > (seen ? surfels.recycle_coverage : surfels.recycle_hidden);
}

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels) return;
  const SurfelState s = states[id];
  flags[id] = s.priority != 0u && goes(id, s) ? 1u : 0u;
}
