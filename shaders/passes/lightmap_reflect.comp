#version 460
#extension GL_GOOGLE_include_directive : require
// What lumels send out: L = albedo / pi * (E direct + E indirect).
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 64) in;

layout(scalar) readonly buffer reflectance_block { vec4 reflectance[]; };  // albedo / pi; w: area
layout(scalar) readonly buffer direct_block { vec4 direct[]; };            // sum; w: samples
layout(scalar) readonly buffer irradiance_block { vec4 irradiance[]; };
layout(scalar) writeonly buffer radiance_block { vec4 radiance[]; };
layout(push_constant, scalar) uniform Constants { uint lumels; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= lumels) return;
  vec4 d = direct[i];
  vec3 e = (d.w > 0.0 ? d.xyz / d.w : vec3(0.0)) + irradiance[i].xyz;
  radiance[i] = vec4(reflectance[i].xyz * e, 0.0);
}
