#version 460
#extension GL_GOOGLE_include_directive : require
// The probes' maps of distance for people: red the mean, green the standard deviation, as shares of the distance at which they are cut, whatever the
// scene's scale. Blue: probes that are not asked.
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
    colour = texelFetch(probes, int(probe)).w == float(kProbeActive) ? vec3(vec2(moments.x, deviation) / grid.farthest, 0.0) : vec3(0.0, 0.0, 0.25);
  }
  imageStore(result, at, vec4(colour, 1.0));
}
