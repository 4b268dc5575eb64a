#version 460
#extension GL_EXT_scalar_block_layout : require
// 16 bytes a thread: what the device's copy rate is measured with.
layout(local_size_x = 256) in;

layout(scalar) readonly buffer from_block { uvec4 from[]; };
layout(scalar) writeonly buffer to_block { uvec4 to[]; };
layout(push_constant, scalar) uniform Constants { uint count; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < count) to[i] = from[i];
}
