#pragma once
// SurfelsParams, its enums and its table.
#define HL_PARAM_LIST "engine/techniques/surfels/params.inl"
#include "engine/params/declare_group.h"
