#version 460
#extension GL_GOOGLE_include_directive : require
// The least covered pixel of each tile asks for a surfel (Ekberg 2022, section 4.5).
#define HL_SURFELS_CLAIMS
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rg32ui) readonly uniform uimage2D ids;
layout(rgba32f) readonly uniform image2D irradiance;

shared uint least;

const float kCoverageUnit = 4096.0;  ///< steps in which coverages are told apart
const uint kNothing = 0xffffffffu;

/// Whether this tile's turn has come: by chance, so that neighbouring tiles seldom ask for the same place.
bool allowed(uint tile, vec3 at) {
  float chance = surfels.place_chance;
  if (surfels.chance_by_size != 0) {
    const float r = surfels.sizing == kSizingScreen ? surfels.radius_pixels : frame.radius / max(frame.pixelAngle * distance(at, frame.eye), 1e-30);
    chance *= min(1.0, float(kTilePixels * kTilePixels) / (kPi * r * r));
  }
  Random random = randomInit(frame.seed ^ 0x51f15eedu, tile, frame.frame);
  return randomFloat(random) < chance;
}

void main() {
  const uint i = gl_LocalInvocationIndex;
  if (i == 0u) least = kNothing;
  barrier();
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const bool inside = all(lessThan(pixel, imageSize(position)));
  const vec4 place = inside ? imageLoad(position, pixel) : vec4(0.0);
  uint key = kNothing;
  if (place.w != 0.0) {
    const float covered = imageLoad(irradiance, pixel).w;
    // Equally covered ones in an order of their own each frame: else the first surfels would line up with the tiles.
    const uint shuffled = (i * 167u + pcgHash(frame.frame ^ pcgHash(gl_WorkGroupID.x + gl_WorkGroupID.y * 65536u))) & 255u;
    if (covered < surfels.coverage) key = (min(uint(covered * kCoverageUnit), 0xfffffeu) << 8u) | shuffled;
  }
  atomicMin(least, key);
  barrier();
  const uint tile = gl_WorkGroupID.y * frame.tilesX + gl_WorkGroupID.x;
  if (least == kNothing) {
    if (i == 0u) proposeNothing(tile);
    return;
  }
  if (key != least) return;
  if (!allowed(tile, place.xyz)) {
    proposeNothing(tile);
    return;
  }
  const vec4 light = imageLoad(irradiance, pixel);
  propose(tile, place.xyz, imageLoad(geometricNormal, pixel).xyz, imageLoad(ids, pixel).x - 1u, light.xyz, light.w);
}
