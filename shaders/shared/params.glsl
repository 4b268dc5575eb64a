#ifndef HALFLIGHT_PARAMS_GLSL
#define HALFLIGHT_PARAMS_GLSL
// Included before parameter lists: each then becomes its enums' constants and a uniform block in scalar layout that matches the C++ struct of
// the same name (engine/params/README.md). `lightmap.inl` gives `uniform LightmapParams { int resolution; ... } lightmap;`.
#include "shaders/shared/interop.h"

#define PARAM_ENUM_BEGIN(type)
#define PARAM_ENUM_VALUE(constant, number, text, help) const int constant = number;
#define PARAM_ENUM_END(type)
#define PARAM_GROUP_BEGIN(group, block) layout(scalar) uniform block {
#define PARAM_INT(name, def, low, high, softLow, softHigh, scale, effect, unit, help) int name;
#define PARAM_FLOAT(name, def, low, high, softLow, softHigh, scale, effect, unit, help) float name;
#define PARAM_BOOL(name, def, effect, help) int name;
#define PARAM_ENUM(name, type, def, effect, help) int name;
#define PARAM_GROUP_END(group, block) } group;
#endif
