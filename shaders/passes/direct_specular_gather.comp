#version 460
#extension GL_GOOGLE_include_directive : require
// Adds what the lobe's rays brought to each pixel's sum; w counts samples.
#include "shaders/passes/direct_lights.glsl"
#include "shaders/passes/direct_lobe.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
layout(scalar) readonly buffer environment_texels { vec3 environmentTexels[]; };
layout(scalar) readonly buffer unshadowed_block { vec3 unshadowed[]; };
layout(scalar) readonly buffer occluded_block { uint occluded[]; };
layout(scalar) readonly buffer lobe_rays { Ray lobeRays[]; };
layout(scalar) readonly buffer lobe_weights { vec3 lobeWeights[]; };
layout(scalar) readonly buffer lobe_hits { Hit lobeHits[]; };
layout(scalar) buffer sums_block { vec4 sums[]; };

/// Among the emitters, which lie in the order of their triangles; batch.emitters where it is none.
uint emitterOf(uint triangle) {
  uint low = 0u, high = batch.emitters;
  while (low < high) {
    uint middle = (low + high) / 2u;
    if (emitters[middle].triangle < triangle) low = middle + 1u; else high = middle;
  }
  return low < batch.emitters && emitters[low].triangle == triangle ? low : batch.emitters;
}

/// What shines back along the lobe's ray, an emitter weighed against having been chosen as a light.
vec3 found(SurfacePoint p, uint pixel, vec3 direction, Hit hit) {
  if (hit.primitive == kMiss) {
    vec3 sky = batch.sky;
    if (batch.environmentRays > 0u) sky += environmentTexels[environmentTexel(batch.environment, direction)];
    return sky;
  }
  uint index = emitterOf(hit.primitive);
  if (index == batch.emitters) return vec3(0.0);
  GpuEmitter e = emitters[index];
  if (dot(cross(e.p1 - e.p0, e.p2 - e.p0), direction) >= 0.0) return vec3(0.0);
  float lightPdf = choiceProbability(p, index);
  if (lightPdf > 0.0) lightPdf *= triangleLightPdf(p.position, e.p0, e.p1, e.p2, direction, hit.t);
  return e.emission * powerHeuristic(pdfOf(lobeOf(p, pixel), p, direction), lightPdf);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= batch.count) return;
  vec3 sum = vec3(0.0);
  uint lightSlots = lobeLightSlots(batch), raySlots = lobeRaySlots(batch);
  for (uint slot = 0u; slot < lightSlots; ++slot) {
    uint ray = slot * batch.count + i;
    if (occluded[ray] == 0u) sum += unshadowed[ray];
  }
  SurfacePoint p = points[batch.pointBase + i];
  for (uint slot = 0u; slot < raySlots; ++slot) {
    uint ray = slot * batch.count + i;
    vec3 weight = lobeWeights[ray];
    if (max(weight.x, max(weight.y, weight.z)) > 0.0) sum += weight * found(p, batch.targetBase + i, lobeRays[ray].direction, lobeHits[ray]);
  }
  sums[batch.targetBase + i] += vec4(sum, float(batch.samples));
}
