#pragma once
// The parameter groups that several techniques share. (A technique's own group is in its folder.)
#include "engine/params/declare.h"

namespace hl {
// Each expands engine/params/<group>.inl to a struct (LightmapParams, DirectParams, ReferenceParams) with defaults, and its table.
HL_PARAM_GROUP_DECLARE(LightmapParams, lightmap)
HL_PARAM_GROUP_DECLARE(DirectParams, direct)
HL_PARAM_GROUP_DECLARE(ReferenceParams, reference)
}  // namespace hl
