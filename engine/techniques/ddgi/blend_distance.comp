#version 460
#extension GL_GOOGLE_include_directive : require
// Mean and mean square of proximities (proximity.glsl) over a narrow lobe round each texel's direction. No bounce follows bounce here: a mean over frames from the start.
#define HL_DDGI_DISTANCE
#include "engine/techniques/ddgi/blend.glsl"

void main() {
  const uint probe = batch.firstProbe + gl_WorkGroupID.x;
  if (probes[probe].w != float(kProbeActive)) return;
  const int texels = ddgi.distance_texels;
  const uint count = uint(texels * texels), thread = gl_LocalInvocationIndex;
  const ivec2 origin = ivec2(probe % grid.tilesAcross, probe / grid.tilesAcross) * (texels + 2);
  const float frames = float(ages[probe]);
  const float kept = min(ddgi.hysteresis, frames / (frames + 1.0));
  for (uint first = 0u; first < count; first += gl_WorkGroupSize.x) {
    const uint texel = first + thread;
    const ivec2 at = ivec2(texel % uint(texels), texel / uint(texels));
    const vec3 normal = octahedralDecode((vec2(at) + 0.5) / float(texels) * 2.0 - 1.0);
    vec3 sum = vec3(0.0);
    for (uint chunk = 0u; chunk < batch.rays; chunk += kChunk) {
      barrier();
      const uint r = gl_WorkGroupID.x * batch.rays + chunk + thread;
      if (chunk + thread < batch.rays) {
        directions[thread] = rays[r].direction;
        values[thread] = radiance[r].w;
      }
      barrier();
      const uint n = min(kChunk, batch.rays - chunk);
      for (uint j = 0u; j < n; ++j) {
        const float w = pow(max(0.0, dot(directions[j], normal)), ddgi.distance_exponent);
        sum += w * vec3(values[j], values[j] * values[j], 1.0);
      }
    }
    if (texel < count) {
      const vec2 known = imageLoad(before, origin + at + 1).xy;
      // A lobe that few rays fell into says little: it moves what is known by as much less.
      const float moves = frames == 0.0 ? 1.0 : (1.0 - kept) * min(1.0, sum.z);
      vec2 now = sum.z > 0.0 ? sum.xy / sum.z : vec2(proximity(kNothing), proximity(kNothing) * proximity(kNothing));
      if (moves < 1.0) now = mix(known, now, moves);
      tile[texel] = now;
      if (anyNan(now)) atomicAdd(counters[kCountNan], 1u);
      else if (anyInf(now)) atomicAdd(counters[kCountInf], 1u);
    }
  }
  barrier();
  const uint side = uint(texels + 2);
  for (uint i = thread; i < side * side; i += gl_WorkGroupSize.x) {
    const ivec2 at = ivec2(i % side, i / side), from = inside(at, texels) - 1;
    imageStore(after, origin + at, vec4(tile[from.y * texels + from.x], 0.0, 1.0));
  }
}
