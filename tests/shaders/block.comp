#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/interop.h"
// Writes what a uniform block of mixed members holds, so that a test sees every offset.
layout(local_size_x = 1) in;
layout(scalar) uniform Settings {
  float scale;
  vec3 colour;
  uint count;
} settings;
layout(scalar) writeonly buffer Result { float result[]; };
layout(scalar) readonly buffer Unused { float unused[]; };

void main() {
  result[0] = settings.scale;
  result[1] = settings.colour.x;
  result[2] = settings.colour.y;
  result[3] = settings.colour.z;
  result[4] = float(settings.count);
}
