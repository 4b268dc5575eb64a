#version 460
#extension GL_GOOGLE_include_directive : require
#define HL_ANY 0
#define HL_ALPHA 0
#include "shaders/bvh/traverse.glsl"
