#ifndef HALFLIGHT_RANDOM_H
#define HALFLIGHT_RANDOM_H
// Counter-based random numbers: a value is a function of (seed, index, frame, dimension) alone, on the CPU and on the GPU alike.
// PCG's output permutation as a hash: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_INLINE uint pcgHash(uint v) {
  uint state = v * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

struct Random {
  uint key;      ///< hash of (seed, index, frame)
  uint counter;  ///< the next dimension
};

HL_INLINE Random randomInit(uint seed, uint index, uint frame) {
  Random r;
  r.key = pcgHash(index ^ pcgHash(frame ^ pcgHash(seed)));
  r.counter = 0u;
  return r;
}

HL_INLINE uint randomUint(HL_INOUT(Random) r) {
  r.counter += 1u;
  return pcgHash(r.key ^ pcgHash(r.counter));
}

/// Uniform in [0, 1): 24 bits, so that 1 is never returned.
HL_INLINE float randomFloat(HL_INOUT(Random) r) { return float(randomUint(r) >> 8u) * (1.0f / 16777216.0f); }

HL_END
#endif
