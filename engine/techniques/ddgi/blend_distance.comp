#version 460
#extension GL_GOOGLE_include_directive : require
// Mean and mean square of proximities (proximity.glsl) over a narrow lobe round each texel's direction. No bounce follows bounce here: a mean over frames from the start.
#define HL_DDGI_DISTANCE
#include "engine/techniques/ddgi/blend.glsl"

/// Texels a thread takes on at once for each ray that it reads: on a CPU device those reads cost more than the arithmetic (README).
const int kBlock = 4;

void main() {
  const uint probe = batch.firstProbe + gl_WorkGroupID.x;
  if (probes[probe].w != float(kProbeActive)) return;
  const int texels = ddgi.distance_texels;
  const uint count = uint(texels * texels), thread = gl_LocalInvocationIndex;
  const ivec2 origin = ivec2(probe % grid.tilesAcross, probe / grid.tilesAcross) * (texels + 2);
  const float frames = float(ages[probe]);
  const float kept = min(ddgi.hysteresis, frames / (frames + 1.0));
  for (uint first = thread; first < count + thread; first += uint(kBlock) * gl_WorkGroupSize.x) {
    vec4 x, y, z;  // of the texels' directions
    for (int k = 0; k < kBlock; ++k) {
      const uint texel = first + uint(k) * gl_WorkGroupSize.x;
      const vec2 at = vec2(texel % uint(texels), texel / uint(texels));
      const vec3 normal = octahedralDecode((at + 0.5) / float(texels) * 2.0 - 1.0);
      x[k] = normal.x, y[k] = normal.y, z[k] = normal.z;
    }
    vec4 sums = vec4(0.0), squares = vec4(0.0), weights = vec4(0.0);
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
        const vec3 d = directions[j];
        const float value = values[j];
        const vec4 w = pow(max(vec4(0.0), d.x * x + d.y * y + d.z * z), vec4(ddgi.distance_exponent));
        sums += w * value, squares += w * (value * value), weights += w;
      }
    }
    for (int k = 0; k < kBlock; ++k) {
      const uint texel = first + uint(k) * gl_WorkGroupSize.x;
      if (texel >= count) break;
      const ivec2 at = origin + ivec2(texel % uint(texels), texel / uint(texels)) + 1;
      const vec2 known = imageLoad(before, at).xy;
      // A lobe that few rays fell into says little: it moves what is known by as much less.
      const float moves = frames == 0.0 ? 1.0 : (1.0 - kept) * min(1.0, weights[k]);
      vec2 now = weights[k] > 0.0 ? vec2(sums[k], squares[k]) / weights[k] : vec2(proximity(kNothing), proximity(kNothing) * proximity(kNothing));
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
