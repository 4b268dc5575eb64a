#ifndef HALFLIGHT_SRP_PROBE_FRAME_H
#define HALFLIGHT_SRP_PROBE_FRAME_H
// Each probe has a frame of its own, in which its rays, its spherical harmonics and the transport from it are. Turning a band-limited function changes nothing, so it costs
// no pass of a frame anything; but with one frame for all, what the finite set of directions gets wrong it gets wrong for all probes alike.
#include "shaders/shared/rotation.h"
HL_BEGIN

/// From the probe's frame to the world's.
HL_INLINE vec4 probeFrame(uint seed, uint probe) {
  Random random = randomInit(seed, probe, 1u);  // frame 0 turns the set itself
  return randomRotation(random);
}

HL_END
#endif
