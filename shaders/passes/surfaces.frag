#version 460
#extension GL_GOOGLE_include_directive : require
// The surface that each pixel sees, from the triangle that it sees: worked out once a pixel, however many triangles lie behind it.
// Drawn, not dispatched: on lavapipe five image stores a pixel cost more than all the rest.
#define HL_SCENE_POSITIONS
#define HL_SCENE_NORMALS
#define HL_SCENE_UVS
#define HL_SCENE_MATERIALS
#define HL_SCENE_TEXTURES
#include "shaders/passes/gbuffer.glsl"

layout(constant_id = 0) const bool kTextured = false;
layout(constant_id = 1) const bool kNormalMaps = false;
layout(constant_id = 2) const bool kLightmap = false;

layout(scalar) readonly buffer corner_uvs_block { vec2 cornerUvs[]; };
uniform usampler2D ids;

layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outNormal;
layout(location = 2) out vec4 outGeometricNormal;
layout(location = 3) out vec4 outAlbedo;
layout(location = 4) out vec4 outEmission;

void main() {
  const uvec2 seen = texelFetch(ids, ivec2(gl_FragCoord.xy), 0).xy;
  outPosition = outNormal = outGeometricNormal = outAlbedo = outEmission = vec4(0.0);
  if (seen.x == 0u) return;
  const uint triangle = seen.x - 1u;
  const vec3 direction = pixelDirection(gl_FragCoord.xy);
  const Triangle t = fetchTriangle(triangle);
  const vec2 bary = meet(t, direction);
  vec2 uv = vec2(0.0);
  if (kTextured || kNormalMaps) uv = fetchUv(triangle, bary);
  const GpuMaterial material = materials[seen.y];

  const vec3 flatNormal = triangleNormal(t);
  vec3 smoothNormal = fetchSmoothNormal(triangle, bary, flatNormal);
  if (kNormalMaps) smoothNormal = mappedNormal(triangle, t, material, uv, smoothNormal);
  const bool front = dot(flatNormal, direction) < 0.0;
  const float side = front ? 1.0 : -1.0;

  vec2 lightmapUv = vec2(0.0);
  if (kLightmap) lightmapUv = interpolate(cornerUvs[3u * triangle], cornerUvs[3u * triangle + 1u], cornerUvs[3u * triangle + 2u], bary);
  outPosition = vec4(trianglePosition(t, bary), side);
  outNormal = vec4(side * smoothNormal, lightmapUv.x);
  outGeometricNormal = vec4(side * flatNormal, lightmapUv.y);
  vec3 albedo = vec3(0.0);
  if (front || isTwoSided(material)) albedo = kTextured ? materialAlbedo(material, uv) : min(material.albedo, vec3(kMaxAlbedo));
  outAlbedo = vec4(albedo, 1.0);
  outEmission = vec4(materialEmission(material, front), 1.0);
}
