#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/interop.h"
// Sums a texel buffer, a sampled image, a layer of a texture array and an integer image into a storage image.
layout(local_size_x = 8, local_size_y = 8) in;
uniform samplerBuffer table;
uniform sampler2D picture;
uniform sampler2DArray layers;
uniform usampler2D labels;
layout(rgba32f) writeonly uniform image2D result;

void main() {
  ivec2 size = imageSize(result), p = ivec2(gl_GlobalInvocationID.xy);
  if (p.x >= size.x || p.y >= size.y) return;
  vec2 uv = (vec2(p) + 0.5) / vec2(size);
  uint label = texelFetch(labels, p, 0).x;
  imageStore(result, p, texelFetch(table, p.y * size.x + p.x) + textureLod(picture, uv, 0.0) + textureLod(layers, vec3(uv + 1.0, 1.0), 0.0) +
                            vec4(float(label)));
}
