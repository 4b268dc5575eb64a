#pragma once
// RadiosityParams, its enums and its table.
#define HL_PARAM_LIST "engine/techniques/radiosity/params.inl"
#include "engine/params/declare_group.h"
