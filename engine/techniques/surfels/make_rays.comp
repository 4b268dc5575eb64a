#version 460
#extension GL_GOOGLE_include_directive : require
// This frame's rays: each surfel's next directions, cosine distributed (or where the guide says).
#define HL_SURFELS_STATES
#define HL_SURFELS_RECORDS
#include "engine/techniques/surfels/cache.glsl"
#include "engine/techniques/surfels/guide.glsl"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kGuiding = false;

layout(scalar) readonly buffer share_sums { uint shareSums[]; };
layout(scalar) readonly buffer sites_block { Surfel sites[]; };
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(scalar) writeonly buffer samples_block { RaySample samples[]; };
layout(push_constant, scalar) uniform Constants { float offset; };

const float kFar = 1e30;

void main() {
  const uint ray = gl_GlobalInvocationID.x;
  if (ray >= frame.rays) return;
  if (ray >= firstRay(shareSums[frame.surfels])) {
    rays[ray] = Ray(vec3(0.0), 1.0, vec3(0.0, 0.0, 1.0), 0.0);
    samples[ray] = RaySample(kNoSurfel, 0u, 0.0);
    return;
  }
  // The last surfel whose rays begin here or before.
  uint id = 0u, high = frame.surfels;
  while (high - id > 1u) {
    const uint middle = (id + high) / 2u;
    if (firstRay(shareSums[middle]) <= ray) id = middle; else high = middle;
  }
  // Each surfel walks its own sequence through all frames. A guide follows what the last points found, and points that follow from these would no longer be
  // independent of it (the Cornell box came out 1.6 % too bright): with it each frame begins a sequence of its own.
  const uint inFrame = ray - firstRay(shareSums[id]), key = pcgHash(id ^ pcgHash(sites[id].birth ^ pcgHash(frame.seed ^ (kGuiding ? pcgHash(frame.frame) : 0u))));
  vec2 u = r2Point(kGuiding ? inFrame : states[id].rays + inFrame, uvec2(key, pcgHash(key)));
  float weight = 1.0;
  if (kGuiding) weight = warpByGuide(id, surfels.guide_uniform, u);
  const vec3 position = records[kRecordTexels * id].xyz, normal = records[kRecordTexels * id + 1u].xyz;
  rays[ray] = Ray(position + normal * offset, 0.0, fromLocal(sampleCosineHemisphere(u), normal), kFar);
  samples[ray] = RaySample(id, squareTo16(u), weight);
}
