#version 460
#extension GL_GOOGLE_include_directive : require
// Of those that want a surfel in the same place, the first gets it.
#define HL_SURFELS_CLAIMS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) writeonly buffer flags_block { uint flags[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= frame.candidates) return;
  const uint claim = candidates[i].claim;
  flags[i] = claim != kNoClaim && (surfels.claim_places == 0 || claims[claim] == i) ? 1u : 0u;
}
