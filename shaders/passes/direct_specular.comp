#version 460
#extension GL_GOOGLE_include_directive : require
// Rays for the light that lobes reflect without a bounce: one to each punctual light and to an emitter a sample, with what it brings where nothing stands in its
// way; and one a sample where the lobe itself looks.
#include "shaders/passes/direct_lights.glsl"
#include "shaders/passes/direct_lobe.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(scalar) writeonly buffer unshadowed_block { vec3 unshadowed[]; };
layout(scalar) writeonly buffer lobe_rays { Ray lobeRays[]; };
layout(scalar) writeonly buffer lobe_weights { vec3 lobeWeights[]; };

const uint kLobeDimension = 0x9e3779b1u;

/// Uniform in solid angle over the emitter, weighed against the lobe's finding it.
Sample sampleEmitter(SurfacePoint p, Lobe lobe, uint index, uint key) {
  Sample s = Sample(kNoRay, vec3(0.0));
  vec2 u = shuffledSobolPoint(index, key ^ kEmitterDimension);
  Choice c = choose(p, shuffledSobolPoint(index, key ^ kChoiceDimension).x);
  if (!(c.probability > 0.0)) return s;
  GpuEmitter e = emitters[c.index];
  TriangleSample t = sampleTriangleLight(p.position, e.p0, e.p1, e.p2, u);
  vec3 normal = normalize(cross(e.p1 - e.p0, e.p2 - e.p0));
  if (!(t.pdf > 0.0) || dot(normal, t.direction) >= 0.0) return s;
  float density = t.pdf * c.probability;
  s.irradiance = e.emission * (receivedCosine(p, t.direction) / density * powerHeuristic(density, pdfOf(lobe, p, t.direction)));
  vec3 target = p.position + t.direction * t.distance + normal * p.offset;
  s.ray = Ray(rayOrigin(p), 0.0, target - rayOrigin(p), 1.0);
  return s;
}

void main() {
  uint i = gl_GlobalInvocationID.x, slot = gl_GlobalInvocationID.y;
  if (i >= batch.count) return;
  SurfacePoint p = points[batch.pointBase + i];
  Lobe lobe = lobeOf(p, batch.targetBase + i);
  bool glossy = isGlossy(p, lobe);
  uint key = pcgHash((batch.targetBase + i) ^ pcgHash(batch.seed));
  uint lightSlots = lobeLightSlots(batch);
  if (slot < lightSlots) {
    Sample s = Sample(kNoRay, vec3(0.0));
    if (glossy && slot < batch.lights) s = samplePunctual(p, lights[slot]);
    else if (glossy) s = sampleEmitter(p, lobe, batch.firstSample + slot - batch.lights, key);
    vec3 radiance = vec3(0.0);
    if (max(s.irradiance.x, max(s.irradiance.y, s.irradiance.z)) > 0.0) radiance = s.irradiance * brdfOf(lobe, p, normalize(s.ray.direction));
    bool dark = !(max(radiance.x, max(radiance.y, radiance.z)) > 0.0);
    uint ray = slot * batch.count + i;
    rays[ray] = dark ? kNoRay : s.ray;
    unshadowed[ray] = dark ? vec3(0.0) : radiance;
    return;
  }
  Ray ray = kNoRay;
  vec3 weight = vec3(0.0);
  if (glossy) {
    GgxSample g = sampleGgx(lobe.view, lobe.f0, lobe.roughness, shuffledSobolPoint(batch.firstSample + slot - lightSlots, key ^ kLobeDimension));
    vec3 direction = fromLocal(g.light, p.normal);
    if (dot(p.geometricNormal, direction) > 0.0) {
      weight = g.weight;
      ray = Ray(rayOrigin(p), 0.0, direction, kFar);
    }
  }
  bool dark = !(max(weight.x, max(weight.y, weight.z)) > 0.0);
  uint at = (slot - lightSlots) * batch.count + i;
  lobeRays[at] = dark ? kNoRay : ray;
  lobeWeights[at] = dark ? vec3(0.0) : weight;
}
