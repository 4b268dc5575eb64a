#version 460
#extension GL_GOOGLE_include_directive : require
// New surfels. Which number each gets follows from prefix sums: numbers on the stack of free ones first, from its top, then fresh ones.
#define HL_SURFELS_STATES
#define HL_SURFELS_RECORDS
#define HL_SURFELS_TOTALS
#define HL_SURFELS_CLAIMS
#include "engine/techniques/surfels/cache.glsl"
#include "engine/techniques/surfels/guide.glsl"
#define HL_SCENE_OBJECTS
#define HL_SCENE_TRANSFORMS
#include "shaders/scene.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kDepthTest = false;
layout(constant_id = 1) const bool kGuiding = false;

layout(scalar) readonly buffer flags_block { uint flags[]; };
layout(scalar) readonly buffer order_block { uint order[]; };
layout(scalar) readonly buffer free_ids { uint freeIds[]; };
layout(scalar) writeonly buffer sites_block { Surfel sites[]; };
layout(scalar) buffer depth_moments { vec2 depthMoments[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= frame.candidates || flags[i] == 0u) return;
  const uint k = order[i];
  const uint id = k < totals.freeCount ? freeIds[totals.freeCount - 1u - k] : totals.highWater + (k - totals.freeCount);
  if (id >= frame.maxSurfels) {
    countOne(kCountMaxReached);
    return;
  }
  const Candidate c = candidates[i];
  const uint object = objectIds[c.triangle];
  const ObjectTransform t = objectTransforms[object];
  sites[id] = Surfel(c.position, object, c.normal, frame.frame);
  if (t.movable != 0u) {
    sites[id].position = (t.worldToRest * vec4(c.position, 1.0)).xyz;
    sites[id].normal = normalize(transpose(mat3(t.restToWorld)) * c.normal);
  }
  const bool seeded = c.seedWeight > 0.0 && surfels.seed_samples > 0.0 && !isNotFinite(c.seed);
  // What a ray places is out of view until a pixel finds it: with the shorter reach the next rays would place it again. (Frame numbers wrap.)
  const uint seen = i < frame.tiles ? frame.frame : frame.frame - frame.recent - 1u;
  SurfelState s = SurfelState(vec3(0.0), 0.0, vec3(0.0), 1.0, vec3(0.0), 1.0, 0u, frame.frame, seen, 1u);
  if (seeded) {
    s.mean = s.shortMean = c.seed;
    // An exponential average goes on from where its neighbours are, else its first samples would weigh more than theirs, and it would run ahead of them.
    s.samples = surfels.estimator == kEstimatorEma ? max(surfels.seed_samples, 1.0 / max(1.0 - surfels.hysteresis, 1e-4)) : surfels.seed_samples;
  }
  s.priority = min(uint(kPriorityUnit * (1.0 + surfels.inconsistency_gain)), kMaxPriority);
  atomicAdd(totals.priority, s.priority);
  states[id] = s;
  records[kRecordTexels * id] = vec4(c.position, 0.0);
  records[kRecordTexels * id + 1u] = vec4(c.normal, seeded ? s.samples / (s.samples + surfels.fade_in) : 0.0);
  records[kRecordTexels * id + 2u] = vec4(s.mean, 0.0);
  if (kDepthTest)
    for (uint t = 0u; t < kDepthSide * kDepthSide; ++t) depthMoments[id * kDepthSide * kDepthSide + t] = vec2(kUnknownDepth, 0.0);
  if (kGuiding)
    for (uint t = 0u; t < kGuideTexels; ++t) guideMaps[id * kGuideTexels + t] = 0.0;
  countOne(i < frame.tiles ? kCountPlacedPixels : kCountPlacedHits);
}
