#version 460
#extension GL_GOOGLE_include_directive : require
// What each surfel's rays brought goes into its estimate, its map of distances and its guide; then its priority for the next frame.
#define HL_SURFELS_STATES
#define HL_SURFELS_RECORDS
#define HL_SURFELS_TOTALS
#include "engine/techniques/surfels/cache.glsl"
#include "engine/techniques/surfels/guide.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool kDepthTest = false;
layout(constant_id = 1) const bool kGuiding = false;

layout(scalar) readonly buffer sites_block { Surfel sites[]; };
layout(scalar) readonly buffer share_sums { uint shareSums[]; };
layout(scalar) readonly buffer samples_block { RaySample samples[]; };
layout(scalar) readonly buffer arrivals_block { vec4 arrivals[]; };
layout(scalar) buffer depth_moments { vec2 depthMoments[]; };

// Constants of the multi-scale mean that no parameter has (Barre-Brisebois et al. 2019, listing 25-1), none of which depends on the light's scale.
const float kInconsistencyBlend = 0.08, kReductionBlend = 0.1, kLeastReduction = 1.0 / 32.0;
const float kInconsistencyKnee = 0.2, kLeastSlope = 0.02;
const float kLeastDeviation = 1e-3;   ///< as a share of the mean: below it rounding alone looks inconsistent
const float kMostInconsistency = 16.0;
const float kDepthBlend = 0.05, kGuideBlend = 0.05;  ///< least shares of a new sample in the maps
const float kNewborn = 16.0;                         ///< samples up to which a surfel counts as inconsistent, as newly placed ones do in the thesis

/// The long mean's window is the latest n-th part of a surfel's samples. Where light feeds back (x = d + rho x), what is missing after n samples falls as
/// n^-(growth (1 - rho)): slowly if growth is small. Noise falls with growth small. So it starts large and shrinks.
float windowGrowth(float samples) {
  return surfels.window_growth > 0.0 ? max(min(surfels.window_growth, 2.0), surfels.window_growth / (1.0 + samples / surfels.window_settle)) : 0.0;
}
/// What has to be forgotten is how dark the whole cache began: a surfel that came when the others had learnt keeps all its samples (growth 1: a plain mean), until
/// the window that surfels of the cache's age have has become shorter than its life.
float windowGrowthOf(SurfelState s, uint birth) {
  const float growth = windowGrowth(s.samples);
  return growth > 1.0 ? max(1.0, growth * min(1.0, float(frame.frame - birth) / max(frame.age, 1.0))) : growth;
}

/// The new mean, with what one frame's rays brought on average.
void addSample(inout SurfelState s, uint birth, vec3 value) {
  const bool first = s.samples <= 0.0;
  if (surfels.firefly_limit > 0.0 && s.samples > kNewborn) {
    // Where nothing has varied yet, no deviation is known: a limit of 0 would keep what has seen only black so far black for ever.
    const vec3 cut = min(value, s.shortMean + surfels.firefly_limit * sqrt(s.variance) + kLeastDeviation * s.mean);
    const vec3 kept = mix(value, cut, greaterThan(s.variance, vec3(0.0)));
    if (kept != value) countOne(kCountFireflies);
    value = kept;
  }
  if (first) {
    s.mean = s.shortMean = value;
    s.samples = 1.0;
    return;
  }
  const vec3 toShort = value - s.shortMean;
  s.shortMean += surfels.short_blend * toShort;
  s.variance = mix(s.variance, max(vec3(0.0), toShort * (value - s.shortMean)), 0.5 * surfels.short_blend);
  const vec3 deviation = max(sqrt(s.variance), kLeastDeviation * (abs(s.mean) + abs(s.shortMean))) + 1e-30;
  const float difference = min(luminanceOf(abs(s.mean - s.shortMean) / deviation), kMostInconsistency);
  s.inconsistency = mix(s.inconsistency, difference, kInconsistencyBlend);
  float share;
  if (surfels.estimator == kEstimatorMean && frame.frozen != 0u) {
    share = 1.0 / (s.samples + 1.0);
    s.samples += 1.0;
  } else if (surfels.estimator == kEstimatorEma) {
    share = max(1.0 - surfels.hysteresis, 1.0 / (s.samples + 1.0));
    s.samples += 1.0;
  } else {
    const float reduction = clamp(luminanceOf(0.5 * s.shortMean / deviation), kLeastReduction, 1.0);
    float catchUp = smoothstep(0.0, 1.0, difference * max(kLeastSlope, s.inconsistency - kInconsistencyKnee));
    catchUp = max(catchUp, surfels.min_blend) * s.blendReduction;
    s.blendReduction = mix(s.blendReduction, reduction, kReductionBlend);
    const float growth = windowGrowthOf(s, birth);
    share = clamp(max(catchUp, growth / (s.samples + growth)), 0.0, 1.0);
    // What caught up forgets how many samples it rested on, and goes on from there.
    s.samples = min(s.samples + 1.0, max(growth, 1.0) / share);
  }
  s.mean += share * (value - s.mean);
}

void main() {
  const uint id = gl_GlobalInvocationID.x;
  if (id >= frame.surfels) return;
  SurfelState s = states[id];
  if (s.priority == 0u) return;
  if (frame.lightChanged != 0u && surfels.change_samples > 0.0) s.samples = min(s.samples, surfels.change_samples);
  // A window of the latest n-th of N samples is worth N / n of them in a plain mean.
  if (frame.justFrozen != 0u && surfels.estimator == kEstimatorMean) s.samples /= max(1.0, windowGrowthOf(s, sites[id].birth));
  const uint first = frame.rays > 0u ? firstRay(shareSums[id]) : 0u, end = frame.rays > 0u ? firstRay(shareSums[id + 1u]) : 0u;
  const float radius = abs(records[kRecordTexels * id].w);
  vec3 sum = vec3(0.0);
  float count = 0.0;
  for (uint ray = first; ray < end; ++ray) {
    const vec4 arrival = arrivals[ray];
    if (arrival.w < 0.0) continue;
    sum += arrival.xyz;
    count += 1.0;
    const vec2 square = squareOf16(samples[ray].square);
    // Each texel's share of the rays so far decides how fast it learns.
    if (kDepthTest) {
      const uint texel = id * kDepthSide * kDepthSide + squareTexel(square, kDepthSide);
      const float d = min(arrival.w / radius * length(sampleDisc(square)), max(kDepthRange, surfels.hit_reach));
      const float share = max(kDepthBlend, 1.0 / (1.0 + float(s.rays + ray - first) / float(kDepthSide * kDepthSide)));
      const vec2 known = depthMoments[texel];
      depthMoments[texel] = known.x < 0.0 ? vec2(d, d * d) : mix(known, vec2(d, d * d), share);
    }
    if (kGuiding) {
      const uint texel = id * kGuideTexels + squareTexel(square, kGuideSide);
      const float share = max(kGuideBlend, 1.0 / (1.0 + float(s.rays + ray - first) / float(kGuideTexels)));
      guideMaps[texel] = mix(guideMaps[texel], luminanceOf(arrival.xyz) / samples[ray].weight, share);
    }
  }
  s.rays += end - first;
  if (count > 0.0) {
    const SurfelState before = s;
    addSample(s, sites[id].birth, kPi * sum / count);
    if (isNotFinite(s.mean) || isNotFinite(s.shortMean) || isNotFinite(s.variance)) {  // sums of finite rays may overflow
      countOne(kCountInf);
      s = before;
    }
    const float confidence = s.samples / (s.samples + surfels.fade_in);
    records[kRecordTexels * id + 1u].w = confidence;
    records[kRecordTexels * id + 2u] = vec4(s.mean, 0.0);
  }
  const bool seen = seenLately(s.lastSeen);
  float young = 0.0;
  if (seen) atomicAdd(totals.inView, 1u);
  // One that a ray placed is in view to that ray: without these few frames' rays a fresh cache is twice as noisy.
  if (seen || frame.frame - sites[id].birth <= frame.recent) {
    const float growth = max(windowGrowth(s.samples), 1.0);
    young = min(surfels.young_rays * growth / (s.samples + growth), float(surfels.rays_max));
  }
  const float worry = s.samples < kNewborn ? max(1.0, s.inconsistency) : s.inconsistency;
  const float priority = (seen ? 1.0 : surfels.hidden_share) * (1.0 + surfels.inconsistency_gain * worry);
  const uint part = uint(clamp(priority * kPriorityUnit, 1.0, float(kMaxPriority))), beyond = uint(young * kYoungUnit);
  s.priority = part | (beyond << 16u);
  atomicAdd(totals.priority, part);
  atomicAdd(totals.young, beyond);
  states[id] = s;
}
