#version 460
#extension GL_GOOGLE_include_directive : require
// The probes' maps of distance for people, whatever the scene's scale. Red: the mean (of reciprocals the harmonic one) as a share of 1.5 diagonals of a
// cell; green: how much distances in a lobe differ; blue: probes that are not asked.
#include "engine/techniques/ddgi/lookup.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) writeonly uniform image2D result;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(result)))) return;
  const uvec2 tile = uvec2(at) / uint(ddgi.distance_texels + 2);
  const uint probe = tile.x + tile.y * grid.tilesAcross;
  vec3 colour = vec3(0.0);  // no probe: the last row's rest
  if (probe < grid.counts.x * grid.counts.y * grid.counts.z) {
    const vec2 moments = texelFetch(distanceAtlas, at, 0).xy;
    const float deviation = sqrt(max(0.0, moments.y - moments.x * moments.x));
    const float mean = min(distanceOf(moments.x) / grid.farthest, 1.0);
    const float spread = ddgi.visibility_moments == kMomentsPlain ? deviation / grid.farthest : deviation / max(moments.x + deviation, 1e-30);
    colour = texelFetch(probes, int(probe)).w == float(kProbeActive) ? vec3(mean, spread, 0.0) : vec3(0.0, 0.0, 0.25);
  }
  imageStore(result, at, vec4(colour, 1.0));
}
