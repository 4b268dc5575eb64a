#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/interop.h"
layout(scalar) readonly buffer Values { vec4 values[]; };
layout(location = 0) flat in uint triangle;
layout(location = 0) out vec4 colour;
layout(location = 1) out uvec2 id;

void main() {
  colour = values[triangle];
  id = uvec2(triangle + 1, 7);
}
