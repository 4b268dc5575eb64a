#ifndef HALFLIGHT_RADIOSITY_UNIT_H
#define HALFLIGHT_RADIOSITY_UNIT_H
// What C++ and the shaders agree on about one unit of a bake.
#include "shaders/shared/interop.h"
HL_BEGIN

/// What a ray met: the index of a lumel, or one of these. They are larger than any index.
HL_CONST uint kCodeMiss = 0xffffffffu;
HL_CONST uint kCodeBackFace = 0xfffffffeu;   ///< of a surface: reflects nothing
HL_CONST uint kCodeNoTexel = 0xfffffffdu;    ///< a surface without a valid texel near
HL_CONST uint kFirstCode = 0xfffffff0u;

/// In the table from texels to lumels: the texel has no lumel of its own and borrows that of a neighbour of the same chart.
HL_CONST uint kBorrowed = 0x80000000u;
HL_CONST uint kNoLumel = 0xffffffffu;

/// Labels of texels that belong to no chart, and of those between two.
HL_CONST uint kNoChart = 0xffffffffu;
HL_CONST uint kMixedChart = 0xfffffffeu;

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
