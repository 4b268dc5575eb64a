#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_tracing : require
#include "shaders/shared/ray.h"
#include "shaders/pipeline/scene_triangle.glsl"

layout(location = 0) rayPayloadInEXT Hit hit;
hitAttributeEXT vec2 barycentrics;

void main() { hit = Hit(gl_HitTEXT, sceneTriangle(), barycentrics.x, barycentrics.y); }
