#version 460
#extension GL_GOOGLE_include_directive : require
// Radiance towards the camera from irradiance at the surfaces it sees, and from what their lobes reflect.
#include "shaders/shared/interop.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool kDirect = true;  ///< with direct light come emission and sky; without, the image is indirect light alone
layout(constant_id = 1) const bool kIndirect = true;
layout(constant_id = 2) const bool kSpecular = false;
layout(constant_id = 3) const bool kDirectSpecular = false;

uniform sampler2D position;
uniform sampler2D albedo;
uniform sampler2D emission;
uniform sampler2D direct;
uniform sampler2D indirect;
uniform sampler2D specular;
uniform sampler2D directSpecular;
layout(rgba32f) writeonly uniform image2D radiance;
layout(push_constant, scalar) uniform Constants { vec3 sky; };

const float kInversePi = 0.31830988618;

void main() {
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(p, imageSize(radiance)))) return;
  const bool surface = texelFetch(position, p, 0).w != 0.0;
  vec3 sum = kDirect ? surface ? texelFetch(emission, p, 0).rgb : sky : vec3(0.0);
  if (surface) {
    vec3 irradiance = vec3(0.0);
    if (kDirect) irradiance += texelFetch(direct, p, 0).rgb;
    if (kIndirect) irradiance += texelFetch(indirect, p, 0).rgb;
    sum += irradiance * texelFetch(albedo, p, 0).rgb * kInversePi;
    if (kSpecular) sum += texelFetch(specular, p, 0).rgb;
    if (kDirectSpecular) sum += texelFetch(directSpecular, p, 0).rgb;
  }
  imageStore(radiance, p, vec4(sum, 1.0));
}
