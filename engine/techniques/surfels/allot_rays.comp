#version 460
#extension GL_GOOGLE_include_directive : require
// Each surfel's share of the frame's rays, by its priority.
#define HL_SURFELS_STATES
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 64) in;

layout(scalar) writeonly buffer shares_block { uint shares[]; };

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels) return;
  const uint priority = states[id].priority;
  if (priority == 0u || totals.lastPriority == 0u) {
    shares[id] = 0u;
    return;
  }
  const float rays = float(frame.rays), mean = rays / float(max(totals.alive, 1u));
  const float share = rays * (float(priority) / float(totals.lastPriority));
  shares[id] = uint(clamp(share, min(surfels.rays_min, mean), float(surfels.rays_max)) * float(kShareUnit));
}
