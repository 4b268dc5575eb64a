#version 460
#extension GL_GOOGLE_include_directive : require
// Where each pixel's surface was in the previous frame, against where it is (GBuffer::motion).
#define HL_SCENE_OBJECTS
#define HL_SCENE_TRANSFORMS
#include "shaders/passes/gbuffer.glsl"

layout(constant_id = 0) const bool kCameraMoved = false;

// camera.worldToClip is the previous camera's; the rays are those of the present one.
uniform sampler2D position;
uniform usampler2D ids;
layout(location = 0) out vec2 motion;

// Behind the camera there is no place in the image: as far away as no reprojection looks.
const vec2 kNowhere = vec2(1e6);

void main() {
  const ivec2 at = ivec2(gl_FragCoord.xy);
  const uint seen = texelFetch(ids, at, 0).x;
  vec4 before = vec4(pixelDirection(gl_FragCoord.xy), 0.0);  // the sky: infinitely far, so that only turning moves it
  bool moved = kCameraMoved;
  if (seen != 0u) {
    before = vec4(texelFetch(position, at, 0).xyz, 1.0);
    const uint object = objectIds[seen - 1u];
    if (objectTransforms[object].moved != 0u) {
      before = objectTransforms[object].previousRestToWorld * (objectTransforms[object].worldToRest * before);
      moved = true;
    }
  }
  motion = vec2(0.0);
  if (!moved) return;
  const vec4 clip = camera.worldToClip * before;
  motion = clip.w > 0.0 ? (clip.xy / clip.w * 0.5 + 0.5) * camera.size - gl_FragCoord.xy : kNowhere;
}
