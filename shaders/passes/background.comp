#version 460
#extension GL_GOOGLE_include_directive : require
// The environment map, where the camera sees no surface: on top of what the composite put there.
#include "shaders/shared/environment.h"

layout(local_size_x = 8, local_size_y = 8) in;

uniform sampler2D position;
layout(scalar) readonly buffer environment_texels { vec3 environmentTexels[]; };
layout(rgba32f) uniform image2D radiance;
layout(push_constant, scalar) uniform Constants {
  vec3 forward, right, down;  ///< of the camera, as in gbuffer.glsl
  EnvironmentInfo environment;
};

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(p, imageSize(radiance))) || texelFetch(position, p, 0).w != 0.0) return;
  const vec2 onImage = (vec2(p) + 0.5) / vec2(imageSize(radiance)) * 2.0 - 1.0;
  const vec3 seen = environmentTexels[environmentTexel(environment, forward + onImage.x * right + onImage.y * down)];
  imageStore(radiance, p, imageLoad(radiance, p) + vec4(seen, 0.0));
}
