#ifndef HALFLIGHT_SCENE_GLSL
#define HALFLIGHT_SCENE_GLSL
// The scene as shaders read it (engine/scene/gpu_scene.h has the buffers). A shader declares what it will bind and nothing more: before the
// include it defines those of
//   HL_SCENE_POSITIONS   positions, indices
//   HL_SCENE_NORMALS     normals (indices)
//   HL_SCENE_UVS         uvs (indices)
//   HL_SCENE_MATERIALS   materials, material_ids
//   HL_SCENE_OBJECTS     object_ids
//   HL_SCENE_TRANSFORMS  object_transforms
//   HL_SCENE_TEXTURES    textures
//   HL_SCENE_LIGHTS      lights
//   HL_SCENE_EMITTERS    emitters
// Barycentrics (u, v): p = (1 - u - v) p0 + u p1 + v p2. The front of a triangle is where p0 p1 p2 run counter-clockwise.
// Textures are read here alone: bilinear, repeating, row 0 at v = 1, mip level 0, the sRGB curve undone before filtering, with the same arithmetic
// as engine/scene/texture_sampling.h, so that every backend and the host agree.
#include "shaders/shared/scene_types.h"

const float kMaxAlbedo = 0.99;

vec3 interpolate(vec3 a, vec3 b, vec3 c, vec2 bary) { return (1.0 - bary.x - bary.y) * a + bary.x * b + bary.y * c; }
vec2 interpolate(vec2 a, vec2 b, vec2 c, vec2 bary) { return (1.0 - bary.x - bary.y) * a + bary.x * b + bary.y * c; }

#if defined(HL_SCENE_POSITIONS) || defined(HL_SCENE_NORMALS) || defined(HL_SCENE_UVS)
layout(scalar) readonly buffer indices_block { uvec3 indices[]; };
#endif

#ifdef HL_SCENE_POSITIONS
layout(scalar) readonly buffer positions_block { vec3 positions[]; };

struct Triangle {
  vec3 p0;
  vec3 p1;
  vec3 p2;
};

Triangle fetchTriangle(uint triangle) {
  const uvec3 i = indices[triangle];
  return Triangle(positions[i.x], positions[i.y], positions[i.z]);
}

vec3 trianglePosition(Triangle t, vec2 bary) { return interpolate(t.p0, t.p1, t.p2, bary); }

/// Unit, on the front side.
vec3 triangleNormal(Triangle t) { return normalize(cross(t.p1 - t.p0, t.p2 - t.p0)); }

float triangleArea(Triangle t) { return 0.5 * length(cross(t.p1 - t.p0, t.p2 - t.p0)); }
#endif

#ifdef HL_SCENE_NORMALS
layout(scalar) readonly buffer normals_block { vec3 normals[]; };

/// Interpolated vertex normal, unit; the geometric one where the vertices' cancel. On the front side of the surface.
vec3 fetchSmoothNormal(uint triangle, vec2 bary, vec3 geometricNormal) {
  const uvec3 i = indices[triangle];
  const vec3 n = interpolate(normals[i.x], normals[i.y], normals[i.z], bary);
  const float squared = dot(n, n);
  if (squared < 1e-12) return geometricNormal;
  const vec3 unit = n * inversesqrt(squared);
  return dot(unit, geometricNormal) < 0.0 ? -unit : unit;
}
#endif

#ifdef HL_SCENE_UVS
layout(scalar) readonly buffer uvs_block { vec2 uvs[]; };

vec2 fetchUv(uint triangle, vec2 bary) {
  const uvec3 i = indices[triangle];
  return interpolate(uvs[i.x], uvs[i.y], uvs[i.z], bary);
}
#endif

#ifdef HL_SCENE_MATERIALS
layout(scalar) readonly buffer materials_block { GpuMaterial materials[]; };
layout(scalar) readonly buffer material_ids { uint materialIds[]; };

GpuMaterial fetchMaterial(uint triangle) { return materials[materialIds[triangle]]; }
bool isTwoSided(GpuMaterial m) { return (m.flags & kMaterialTwoSided) != 0u; }
bool isEmissive(GpuMaterial m) { return (m.flags & kMaterialEmissive) != 0u; }
#endif

#ifdef HL_SCENE_OBJECTS
layout(scalar) readonly buffer object_ids { uint objectIds[]; };
#endif

#ifdef HL_SCENE_TRANSFORMS
layout(scalar) readonly buffer object_transforms { ObjectTransform objectTransforms[]; };
#endif

#ifdef HL_SCENE_LIGHTS
layout(scalar) readonly buffer lights_block { GpuLight lights[]; };
#endif

#ifdef HL_SCENE_EMITTERS
layout(scalar) readonly buffer emitters_block { GpuEmitter emitters[]; };
#endif

#ifdef HL_SCENE_TEXTURES
uniform sampler2DArray textures;

vec3 srgbToLinear(vec3 c) { return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThanEqual(c, vec3(0.04045))); }

/// The four texels round a point of a texture that fills the upper left `share` of its layer.
struct Taps {
  ivec2 lower;   ///< texel to the left and above
  ivec2 upper;   ///< to the right and below
  vec2 fraction;
};
Taps textureTaps(vec2 share, vec2 uv) {
  const vec2 size = round(vec2(textureSize(textures, 0).xy) * share);
  const vec2 at = vec2(uv.x - floor(uv.x), 1.0 - (uv.y - floor(uv.y))) * size - 0.5;
  const vec2 base = floor(at);
  const ivec2 n = ivec2(size);
  ivec2 lower = ivec2(base), upper = ivec2(base) + 1;
  lower += ivec2(lower.x < 0 ? n.x : lower.x >= n.x ? -n.x : 0, lower.y < 0 ? n.y : lower.y >= n.y ? -n.y : 0);
  upper -= ivec2(upper.x >= n.x ? n.x : 0, upper.y >= n.y ? n.y : 0);
  return Taps(lower, upper, at - base);
}

vec4 decodedTexel(ivec2 at, uint layer, bool srgb) {
  const vec4 texel = texelFetch(textures, ivec3(at, int(layer)), 0);
  return srgb ? vec4(srgbToLinear(texel.rgb), texel.a) : texel;
}

vec4 sampleTexture(uint layer, vec2 share, vec2 uv, bool srgb) {
  const Taps t = textureTaps(share, uv);
  const vec2 f = t.fraction;
  return (1.0 - f.x) * (1.0 - f.y) * decodedTexel(t.lower, layer, srgb) +
         f.x * (1.0 - f.y) * decodedTexel(ivec2(t.upper.x, t.lower.y), layer, srgb) +
         (1.0 - f.x) * f.y * decodedTexel(ivec2(t.lower.x, t.upper.y), layer, srgb) + f.x * f.y * decodedTexel(t.upper, layer, srgb);
}

/// Albedo, at most kMaxAlbedo.
vec3 materialAlbedo(GpuMaterial m, vec2 uv) {
  if (m.albedoTexture == kNoTexture) return min(m.albedo, vec3(kMaxAlbedo));
  return min(m.albedo * sampleTexture(m.albedoTexture, m.albedoUvScale, uv, true).rgb, vec3(kMaxAlbedo));
}

/// Opacity in [0, 1].
float materialAlpha(GpuMaterial m, vec2 uv) {
  if (m.albedoTexture == kNoTexture) return 1.0;
  return sampleTexture(m.albedoTexture, m.albedoUvScale, uv, false).a;
}
bool materialOpaque(GpuMaterial m, vec2 uv) {
  return m.alphaCutoff <= 0.0 || m.albedoTexture == kNoTexture || materialAlpha(m, uv) >= m.alphaCutoff;
}
#elif defined(HL_SCENE_MATERIALS)
/// Without textures: for scenes whose features have none.
vec3 materialAlbedo(GpuMaterial m, vec2 uv) { return min(m.albedo, vec3(kMaxAlbedo)); }
#endif

#if defined(HL_SCENE_TEXTURES) && defined(HL_SCENE_POSITIONS) && defined(HL_SCENE_UVS) && defined(HL_SCENE_MATERIALS)
/// The material's normal map at a point, unit; `smoothNormal` where there is no map or no texture direction. The tangent frame is the
/// triangle's: tangent along u and bitangent along v, made orthogonal to the smooth normal.
vec3 mappedNormal(uint triangle, Triangle t, GpuMaterial m, vec2 uv, vec3 smoothNormal) {
  if (m.normalTexture == kNoTexture) return smoothNormal;
  const uvec3 i = indices[triangle];
  const vec2 a = uvs[i.y] - uvs[i.x], b = uvs[i.z] - uvs[i.x];
  const float area = a.x * b.y - a.y * b.x;
  if (area == 0.0) return smoothNormal;
  const vec3 alongU = sign(area) * (b.y * (t.p1 - t.p0) - a.y * (t.p2 - t.p0));
  const vec3 alongV = sign(area) * (a.x * (t.p2 - t.p0) - b.x * (t.p1 - t.p0));
  const vec3 projected = alongU - smoothNormal * dot(smoothNormal, alongU);
  const float squared = dot(projected, projected);
  if (squared == 0.0) return smoothNormal;
  const vec3 tangent = projected * inversesqrt(squared);
  vec3 bitangent = cross(smoothNormal, tangent);
  if (dot(bitangent, alongV) < 0.0) bitangent = -bitangent;
  const vec3 local = sampleTexture(m.normalTexture, m.normalUvScale, uv, false).xyz * 2.0 - 1.0;
  const vec3 n = local.x * tangent + local.y * bitangent + local.z * smoothNormal;
  const float length2 = dot(n, n);
  return length2 > 0.0 ? n * inversesqrt(length2) : smoothNormal;
}
#endif

/// Radiance towards a viewer on the front side (emitters are one-sided).
#ifdef HL_SCENE_MATERIALS
vec3 materialEmission(GpuMaterial m, bool front) { return front ? m.emission : vec3(0.0); }
#endif
#endif
