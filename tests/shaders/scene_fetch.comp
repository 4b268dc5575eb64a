#version 460
#extension GL_GOOGLE_include_directive : require
// Everything shaders/scene.glsl looks up, at given points of given triangles.
#define HL_SCENE_POSITIONS
#define HL_SCENE_NORMALS
#define HL_SCENE_UVS
#define HL_SCENE_MATERIALS
#define HL_SCENE_OBJECTS
#define HL_SCENE_TEXTURES
#define HL_SCENE_LIGHTS
#define HL_SCENE_EMITTERS
#include "shaders/scene.glsl"
layout(local_size_x = 64) in;

struct Place {
  uint triangle;
  float u;
  float v;
  uint unused;
};
struct Found {
  vec3 position;
  float alpha;
  vec3 geometricNormal;
  uint object;
  vec3 smoothNormal;
  uint opaque;
  vec3 mapped;
  float area;
  vec3 albedo;
  float lightIntensity;
  vec3 emission;
  float emitterArea;
  vec2 uv;
  uvec2 unused;
};
layout(scalar) readonly buffer places_block { Place places[]; };
layout(scalar) writeonly buffer found_block { Found found[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= uint(places.length())) return;
  const Place p = places[i];
  const vec2 bary = vec2(p.u, p.v);
  const Triangle t = fetchTriangle(p.triangle);
  const GpuMaterial m = fetchMaterial(p.triangle);
  Found f;
  f.position = trianglePosition(t, bary);
  f.geometricNormal = triangleNormal(t);
  f.area = triangleArea(t);
  f.smoothNormal = fetchSmoothNormal(p.triangle, bary, f.geometricNormal);
  f.uv = fetchUv(p.triangle, bary);
  f.mapped = mappedNormal(p.triangle, t, m, f.uv, f.smoothNormal);
  f.albedo = materialAlbedo(m, f.uv);
  f.alpha = materialAlpha(m, f.uv);
  f.opaque = materialOpaque(m, f.uv) ? 1u : 0u;
  f.emission = isEmissive(m) ? materialEmission(m, true) : vec3(0.0);
  f.object = objectIds[p.triangle];
  f.lightIntensity = lights[0].intensity.x;
  f.emitterArea = emitters[0].area;
  f.unused = uvec2(0u);
  found[i] = f;
}
