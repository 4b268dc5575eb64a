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
  // What young ones get beyond ray_budget takes nothing from the others. Where the batch is cut to what the device casts, all get less alike.
  const float young = float(totals.lastYoung) / kYoungUnit, alive = float(max(totals.alive, 1u));
  const float rays = float(frame.rays), budget = max(0.0, rays - surfels.ray_budget * young), mean = budget / alive;
  const float share = budget * (float(priority & kPriorityMask) / float(totals.lastPriority));
  const float beyond = min(surfels.ray_budget, rays / max(young, 1e-6)) * float(priority >> 16u) / kYoungUnit;
  shares[id] = uint((clamp(share, min(surfels.rays_min, mean), float(surfels.rays_max)) + beyond) * float(kShareUnit));
}
