#pragma once
// The parameter groups that several techniques share: LightmapParams, ProbesParams, DirectParams, ReferenceParams. A technique's own group is in its folder.
// README.md beside this file says how a list file becomes a struct, a table and a GLSL block.
#define HL_PARAM_LIST "engine/params/lightmap.inl"
#include "engine/params/declare_group.h"

#define HL_PARAM_LIST "engine/params/probes.inl"
#include "engine/params/declare_group.h"

#define HL_PARAM_LIST "engine/params/direct.inl"
#include "engine/params/declare_group.h"

#define HL_PARAM_LIST "engine/params/reference.inl"
#include "engine/params/declare_group.h"

namespace hl {

/// The tables of the shared groups, in the order they are shown.
std::vector<std::span<const ParamInfo>> sharedParamGroups();

}  // namespace hl
