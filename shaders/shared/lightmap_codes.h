#ifndef HALFLIGHT_LIGHTMAP_CODES_H
#define HALFLIGHT_LIGHTMAP_CODES_H
// How tables over the lightmap name lumels, charts, and what a ray met.
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

/// Push constants of find_lumels.comp: rays [0, rays) of a batch, whose codes go to codeBase and on.
struct LumelSearch {
  uint rays;
  uint codeBase;
  uint resolution;   ///< of the lightmap, texels a side
};

HL_END
#endif
