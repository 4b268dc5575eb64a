#version 460
#extension GL_GOOGLE_include_directive : require
// Irradiance at pixels: what punctual lights give, which is known after one ray each, plus the mean of the samples so far.
layout(local_size_x = 8, local_size_y = 8) in;

#extension GL_EXT_scalar_block_layout : require
layout(scalar) readonly buffer punctual_block { vec4 punctual[]; };
layout(scalar) readonly buffer sampled_block { vec4 sampled[]; };
layout(rgba32f) writeonly uniform image2D result;

vec3 mean(vec4 sum) { return sum.w > 0.0 ? sum.xyz / sum.w : vec3(0.0); }

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(result);
  if (pixel.x >= size.x || pixel.y >= size.y) return;
  int i = pixel.y * size.x + pixel.x;
  imageStore(result, pixel, vec4(mean(punctual[i]) + mean(sampled[i]), 1.0));
}
