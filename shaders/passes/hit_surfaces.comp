#version 460
#extension GL_GOOGLE_include_directive : require
// Hits as points that receive light, with the albedo they reflect it by. Normals are turned to the side that the ray came from.
#define HL_SCENE_POSITIONS
#define HL_SCENE_NORMALS
#define HL_SCENE_UVS
#define HL_SCENE_MATERIALS
#define HL_SCENE_TEXTURES
#include "shaders/scene.glsl"
#include "shaders/passes/hit_surfaces.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(constant_id = 0) const bool kTextured = false;
layout(constant_id = 1) const bool kNormalMaps = false;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) writeonly buffer points_block { SurfacePoint points[]; };
layout(scalar) writeonly buffer albedo_block { vec4 albedo[]; };
layout(scalar) buffer counters_block { uint counters[]; };
layout(push_constant, scalar) uniform Constants { HitBatch batch; };

shared uint groupCounts[kHitCounters];

struct HitSurface {
  SurfacePoint point;
  vec3 albedo;
};

HitSurface surfaceOf(Ray ray, Hit hit) {
  HitSurface s = HitSurface(SurfacePoint(ray.origin, batch.offset, vec3(0.0), kHitNothing, vec3(0.0), hit.primitive), vec3(0.0));
  if (hit.primitive == kMiss) return s;
  const vec2 bary = vec2(hit.u, hit.v);
  const Triangle t = fetchTriangle(hit.primitive);
  const GpuMaterial material = fetchMaterial(hit.primitive);
  const vec3 flatNormal = triangleNormal(t);
  const bool front = dot(flatNormal, ray.direction) <= 0.0;
  s.point.position = trianglePosition(t, bary);
  if (!front && !isTwoSided(material)) {
    s.point.flags = kHitBackFace;
    return s;
  }
  vec2 uv = vec2(0.0);
  if (kTextured || kNormalMaps) uv = fetchUv(hit.primitive, bary);
  vec3 smoothNormal = fetchSmoothNormal(hit.primitive, bary, flatNormal);
  if (kNormalMaps) smoothNormal = mappedNormal(hit.primitive, t, material, uv, smoothNormal);
  const float side = front ? 1.0 : -1.0;
  s.point.flags = kHitSurface;
  s.point.normal = side * smoothNormal;
  s.point.geometricNormal = side * flatNormal;
  s.albedo = kTextured ? materialAlbedo(material, uv) : min(material.albedo, vec3(kMaxAlbedo));
  return s;
}

void add(uint which, uint n) {
  if (n != 0u && atomicAdd(counters[2u * which], n) > 0xffffffffu - n) atomicAdd(counters[2u * which + 1u], 1u);
}

void main() {
  if (gl_LocalInvocationIndex < kHitCounters) groupCounts[gl_LocalInvocationIndex] = 0u;
  barrier();
  const uint i = gl_GlobalInvocationID.x;
  if (i < batch.count) {
    const HitSurface s = surfaceOf(rays[batch.first + i], hits[batch.first + i]);
    points[i] = s.point;
    albedo[i] = vec4(s.albedo, s.point.flags == kHitSurface ? 1.0 : 0.0);
    if (s.point.flags == kHitNothing) atomicAdd(groupCounts[kCountHitNothing], 1u);
    if (s.point.flags == kHitBackFace) atomicAdd(groupCounts[kCountHitBackFace], 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex < kHitCounters) add(gl_LocalInvocationIndex, groupCounts[gl_LocalInvocationIndex]);
}
