#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_tracing : require
#include "shaders/shared/ray.h"

layout(location = 0) rayPayloadInEXT Hit hit;

void main() { hit.primitive = kMiss; }
