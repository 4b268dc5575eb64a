#version 460
#extension GL_GOOGLE_include_directive : require
// The surface where the ray through the pixel's centre meets the triangle that the rasteriser found. The meeting point is computed from that
// ray, and not from interpolated attributes, so that it is the same on every device and to the accuracy of a ray caster.
#define HL_SCENE_POSITIONS
#define HL_SCENE_NORMALS
#define HL_SCENE_UVS
#define HL_SCENE_MATERIALS
#define HL_SCENE_TEXTURES
#include "shaders/passes/gbuffer.glsl"
#include "shaders/scene.glsl"

layout(constant_id = 0) const bool kAlphaTested = false;
layout(constant_id = 1) const bool kNormalMaps = false;
layout(constant_id = 2) const bool kLightmap = false;

layout(scalar) readonly buffer corner_uvs_block { vec2 cornerUvs[]; };

layout(location = 0) flat in uint triangle;
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outGeometricNormal;
layout(location = 3) out vec4 outAlbedo;
layout(location = 4) out vec4 outEmission;
layout(location = 5) out uvec2 outIds;

/// Barycentrics of the meeting point, moved onto the triangle where the pixel's centre lies just beside it (the rasteriser rounds corners to a
/// fraction of a pixel).
vec2 meet(Triangle t, vec3 direction) {
  const vec3 a = t.p1 - t.p0, b = t.p2 - t.p0;
  const vec3 p = cross(direction, b), fromCorner = camera.origin - t.p0;
  const float determinant = dot(a, p);
  if (determinant == 0.0) return vec2(1.0 / 3.0);
  const vec2 bary = max(vec2(dot(fromCorner, p), dot(direction, cross(fromCorner, a))) / determinant, vec2(0.0));
  return bary / max(bary.x + bary.y, 1.0);
}

void main() {
  const vec2 onImage = gl_FragCoord.xy / camera.size * 2.0 - 1.0;
  const vec3 direction = camera.forward + onImage.x * camera.right + onImage.y * camera.down;
  const Triangle t = fetchTriangle(triangle);
  const vec2 bary = meet(t, direction);
  const vec2 uv = fetchUv(triangle, bary);
  const GpuMaterial material = fetchMaterial(triangle);
  if (kAlphaTested && !materialOpaque(material, uv)) discard;

  const vec3 position = trianglePosition(t, bary), geometric = triangleNormal(t);
  vec3 normal = fetchSmoothNormal(triangle, bary, geometric);
  if (kNormalMaps) normal = mappedNormal(triangle, t, material, uv, normal);
  const bool front = dot(geometric, direction) < 0.0;
  const float side = front ? 1.0 : -1.0;

  vec2 lightmapUv = vec2(0.0);
  if (kLightmap) lightmapUv = interpolate(cornerUvs[3u * triangle], cornerUvs[3u * triangle + 1u], cornerUvs[3u * triangle + 2u], bary);
  outPosition = vec4(position, side);
  outNormal = vec4(side * normal, lightmapUv.x);
  outGeometricNormal = vec4(side * geometric, lightmapUv.y);
  outAlbedo = vec4(front || isTwoSided(material) ? materialAlbedo(material, uv) : vec3(0.0), 1.0);
  outEmission = vec4(materialEmission(material, front), 1.0);
  outIds = uvec2(triangle + 1u, materialIds[triangle]);
}
