#pragma once
// DdgiParams, its enums and its table.
#define HL_PARAM_LIST "engine/techniques/ddgi/params.inl"
#include "engine/params/declare_group.h"
