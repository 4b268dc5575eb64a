#ifndef HALFLIGHT_RADIOSITY_UNIT_H
#define HALFLIGHT_RADIOSITY_UNIT_H
// What C++ and the shaders agree on about one unit of a bake.
#include "shaders/shared/interop.h"
#include "shaders/shared/lightmap_codes.h"
HL_BEGIN

/// Counters, each a pair of words: low, high.
HL_CONST uint kCountBackFace = 0u;
HL_CONST uint kCountNoTexel = 1u;
HL_CONST uint kCountNonFinite = 2u;
HL_CONST uint kCounters = 3u;

/// Push constants of the bake's passes: lumels [firstLumel, firstLumel + lumels), each with the parameters' number of samples.
struct RadiosityUnit {
  uint firstLumel;
  uint lumels;
  uint codeBase;     ///< where the unit's codes start in the buffer bound
  uint seed;
  uint resolution;   ///< of the lightmap
  uint counting;     ///< 1: count what was hit (in the first bounce: once a ray)
};

/// Threads that share a lumel's samples, and lumels in a workgroup.
HL_CONST uint kGatherLanes = 16u;
HL_CONST uint kGatherLumels = 4u;

HL_END
#endif
