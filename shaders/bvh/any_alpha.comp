#version 460
#extension GL_GOOGLE_include_directive : require
#define HL_ANY 1
#define HL_ALPHA 1
#include "shaders/bvh/traverse.glsl"
