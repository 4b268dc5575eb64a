#ifndef HALFLIGHT_GBUFFER_GLSL
#define HALFLIGHT_GBUFFER_GLSL
// What both stages of the G-buffer pass are given.
#include "shaders/shared/interop.h"

layout(push_constant, scalar) uniform Camera {
  mat4 worldToClip;
  vec3 origin;
  vec3 forward;   ///< unit
  vec3 right;     ///< towards the right edge of the image, at distance 1
  vec3 down;      ///< towards its lower edge
  vec2 size;      ///< of the image, in pixels
} camera;
#endif
