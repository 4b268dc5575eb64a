#pragma once
// The parameter groups that several techniques share: LightmapParams, DirectParams, ReferenceParams, DisplayParams. A technique's own group is in
// its folder. Each list file becomes a struct with the defaults, its enums, and (in groups.cpp) its table, by including declare_group.h.
#define HL_PARAM_GROUP lightmap
#define HL_PARAM_STRUCT LightmapParams
#define HL_PARAM_LIST "engine/params/lightmap.inl"
#include "engine/params/declare_group.h"

#define HL_PARAM_GROUP direct
#define HL_PARAM_STRUCT DirectParams
#define HL_PARAM_LIST "engine/params/direct.inl"
#include "engine/params/declare_group.h"

#define HL_PARAM_GROUP reference
#define HL_PARAM_STRUCT ReferenceParams
#define HL_PARAM_LIST "engine/params/reference.inl"
#include "engine/params/declare_group.h"
