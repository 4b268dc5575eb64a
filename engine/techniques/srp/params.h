#pragma once
// SrpParams, its enums and its table.
#define HL_PARAM_LIST "engine/techniques/srp/params.inl"
#include "engine/params/declare_group.h"
