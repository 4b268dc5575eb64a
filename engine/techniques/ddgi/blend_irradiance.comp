#version 460
#extension GL_GOOGLE_include_directive : require
// The mean radiance over the cosine lobe of each texel's direction: E / pi.
#include "engine/techniques/ddgi/blend.glsl"

/// How much of what was known stays.
float historyWeight(uint age) {
  if (ddgi.start == kStartEma) return ddgi.hysteresis;
  if (age < batch.startFrames) return 0.0;
  const float frames = float(age - batch.startFrames) + (batch.startFrames > 0u ? 1.0 : 0.0);
  return min(ddgi.hysteresis, frames / (frames + 1.0));
}

float luminanceOf(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

void main() {
  const uint probe = batch.firstProbe + gl_WorkGroupID.x;
  if (probes[probe].w != float(kProbeActive)) return;
  const int texels = ddgi.irradiance_texels;
  const uint count = uint(texels * texels), thread = gl_LocalInvocationIndex;
  const ivec2 origin = ivec2(probe % grid.tilesAcross, probe / grid.tilesAcross) * (texels + 2);
  const uint age = ages[probe];
  const float kept = historyWeight(age);
  for (uint first = 0u; first < count; first += gl_WorkGroupSize.x) {
    const uint texel = first + thread;
    const ivec2 at = ivec2(texel % uint(texels), texel / uint(texels));
    const vec3 normal = octahedralDecode((vec2(at) + 0.5) / float(texels) * 2.0 - 1.0);
    vec4 sum = vec4(0.0);
    for (uint chunk = 0u; chunk < batch.rays; chunk += kChunk) {
      barrier();
      const uint r = gl_WorkGroupID.x * batch.rays + chunk + thread;
      if (chunk + thread < batch.rays) {
        directions[thread] = rays[r].direction;
        values[thread] = radiance[r].xyz;
      }
      barrier();
      const uint n = min(kChunk, batch.rays - chunk);
      for (uint j = 0u; j < n; ++j) {
        const float w = max(0.0, dot(directions[j], normal));
        sum += vec4(w * values[j], w);
      }
    }
    if (texel < count) {
      vec3 now = sum.w > 0.0 ? sum.xyz / sum.w : vec3(0.0);
      if (ddgi.gamma != 1.0) now = pow(max(now, vec3(0.0)), vec3(1.0 / ddgi.gamma));
      float keep = kept;
      if (keep > 0.0) {
        const vec3 known = imageLoad(before, origin + at + 1).xyz;
        const float a = luminanceOf(known), b = luminanceOf(now);
        if (ddgi.change_threshold > 0.0 && abs(a - b) > ddgi.change_threshold * max(a, b)) keep *= kChangedHistoryShare;
        now = mix(now, known, keep);
      }
      tile[texel] = now;
      if (anyNan(now)) atomicAdd(counters[kCountNan], 1u);
      else if (anyInf(now)) atomicAdd(counters[kCountInf], 1u);
    }
  }
  barrier();
  const uint side = uint(texels + 2);
  for (uint i = thread; i < side * side; i += gl_WorkGroupSize.x) {
    const ivec2 at = ivec2(i % side, i / side), from = inside(at, texels) - 1;
    imageStore(after, origin + at, vec4(tile[from.y * texels + from.x], 1.0));
  }
  if (thread == 0u) ages[probe] = age + 1u;
}
