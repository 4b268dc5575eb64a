#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/interop.h"
// Pixel x of the result: level x + 1 of the second layer.
layout(local_size_x = 2) in;
uniform sampler2DArray layers;
layout(rgba32f) writeonly uniform image2D result;

void main() {
  int x = int(gl_GlobalInvocationID.x);
  imageStore(result, ivec2(x, 0), texelFetch(layers, ivec3(0, 0, 1), x + 1));
}
