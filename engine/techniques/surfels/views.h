#ifndef HALFLIGHT_SURFEL_VIEWS_H
#define HALFLIGHT_SURFEL_VIEWS_H
// Numbers of the debug views, for show.comp and the technique's list of them.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST uint kViewId = 0u;
HL_CONST uint kViewNormal = 1u;
HL_CONST uint kViewAge = 2u;
HL_CONST uint kViewInconsistency = 3u;
HL_CONST uint kViewRays = 4u;
HL_CONST uint kViewRadiance = 5u;
HL_CONST uint kViewCoverage = 6u;
HL_CONST uint kViewGrid = 7u;

HL_END
#endif
