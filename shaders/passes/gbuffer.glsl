#ifndef HALFLIGHT_GBUFFER_GLSL
#define HALFLIGHT_GBUFFER_GLSL
// What the G-buffer's shaders share: the camera, and where the ray through a pixel's centre meets a triangle. The meeting point is computed
// from that ray, and not from interpolated attributes, so that it is the same on every device and to the accuracy of a ray caster.
#include "shaders/scene.glsl"

layout(push_constant, scalar) uniform Camera {
  mat4 worldToClip;
  vec3 origin;
  vec3 forward;  ///< unit
  vec3 right;    ///< towards the right edge of the image, at distance 1
  vec3 down;     ///< towards its lower edge
  vec2 size;     ///< of the image, in pixels
} camera;

/// Not unit. `at`: in pixels, a centre lies at its index plus a half.
vec3 pixelDirection(vec2 at) {
  const vec2 onImage = at / camera.size * 2.0 - 1.0;
  return camera.forward + onImage.x * camera.right + onImage.y * camera.down;
}

#ifdef HL_SCENE_POSITIONS
/// How far inside its triangle a surface point stays, as a share of the largest coordinate: some ten times what single precision rounds. On the very
/// edge, where two walls meet, a point can come to lie behind the other wall, in the dark.
const float kEdgeGap = 4e-6;

/// Barycentrics of the meeting point, moved into the triangle where the pixel's centre lies on its edge or just beside it (the rasteriser rounds
/// corners to a fraction of a pixel).
vec2 meet(Triangle t, vec3 direction) {
  const vec3 a = t.p1 - t.p0, b = t.p2 - t.p0;
  const vec3 p = cross(direction, b), fromCorner = camera.origin - t.p0;
  const float determinant = dot(a, p);
  if (determinant == 0.0) return vec2(1.0 / 3.0);
  const vec2 bary = vec2(dot(fromCorner, p), dot(direction, cross(fromCorner, a))) / determinant;
  const vec3 largest = max(abs(t.p0), max(abs(t.p1), abs(t.p2)));
  const float gap = kEdgeGap * max(largest.x, max(largest.y, largest.z));
  const vec3 heights = length(cross(a, b)) / max(vec3(length(a - b), length(b), length(a)), vec3(1e-30));
  const vec3 inset = min(gap / max(heights, vec3(1e-30)), vec3(0.1));
  const vec3 inside = max(vec3(1.0 - bary.x - bary.y, bary), inset);
  return inside.yz / (inside.x + inside.y + inside.z);
}
#endif
#endif
