#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/interop.h"
// Triangles from a buffer of clip-space corners; every triangle carries its number.
layout(scalar) readonly buffer Corners { vec4 corners[]; };
layout(location = 0) flat out uint triangle;

void main() {
  triangle = gl_VertexIndex / 3;
  gl_Position = corners[gl_VertexIndex];
}
