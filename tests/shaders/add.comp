#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/interop.h"
// out[i] = in[i] * factor + offset, with the factor specialised.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kFactor = 1;
layout(scalar) readonly buffer Source { uint source[]; };
layout(scalar) writeonly buffer Target { uint target[]; };
layout(push_constant, scalar) uniform Push {
  uint count;
  uint offset;
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < push.count) target[i] = source[i] * kFactor + push.offset;
}
