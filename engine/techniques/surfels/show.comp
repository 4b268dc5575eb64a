#version 460
#extension GL_GOOGLE_include_directive : require
// Debug views: at each pixel the surfel that weighs most there, or what the grid holds.
#define HL_SURFELS_LOOKUP
#define HL_SURFELS_STATES
#include "engine/techniques/surfels/cache.glsl"
#include "engine/techniques/surfels/views.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar) readonly buffer sites_block { Surfel sites[]; };
layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rgba32f) readonly uniform image2D irradiance;
layout(rgba32f) writeonly uniform image2D result;
layout(push_constant, scalar) uniform Constants { uint what; };

const float kRim = 0.5;        ///< weight at which a surfel's disc is drawn to end, where it faces the pixel
const float kDim = 0.35;
const float kAgeScale = 256.0, kRayScale = 1024.0;  ///< frames, rays: red
const float kFew = 20.0, kMany = 70.0;              ///< surfels in a cell: green, red (Ekberg 2022, figure 6.1)

vec3 hashColour(uint id) {
  const uint h = pcgHash(id);
  return vec3(0.25) + 0.75 * vec3(float(h & 255u), float((h >> 8u) & 255u), float((h >> 16u) & 255u)) / 255.0;
}
/// Dark blue, green, yellow, red.
vec3 heat(float t) {
  t = clamp(t, 0.0, 1.0) * 3.0;
  if (t < 1.0) return mix(vec3(0.05, 0.08, 0.4), vec3(0.1, 0.7, 0.25), t);
  if (t < 2.0) return mix(vec3(0.1, 0.7, 0.25), vec3(1.0, 0.85, 0.1), t - 1.0);
  return mix(vec3(1.0, 0.85, 0.1), vec3(0.8, 0.05, 0.05), t - 2.0);
}

vec3 colourOf(vec3 p, vec3 n, float coverage) {
  if (what == kViewCoverage) return coverage < surfels.coverage ? vec3(0.8, 0.05, 0.05) * (0.3 + 0.7 * coverage / surfels.coverage) : heat(coverage / 6.0);
  if (what == kViewGrid) {
    const uint cell = cellAt(p);
    const float count = float(cellOffsets[cell + 1u] - cellOffsets[cell]);
    const float shade = 0.75 + 0.25 * float(pcgHash(cell) & 255u) / 255.0;  // tells cells apart
    return mix(vec3(0.1, 0.7, 0.25), vec3(0.8, 0.05, 0.05), clamp((count - kFew) / (kMany - kFew), 0.0, 1.0)) * shade;
  }
  const Gathered g = gatherAt(p, n, false);
  if (g.nearest == kNoSurfel) return vec3(0.5, 0.0, 0.5);
  const SurfelState s = states[g.nearest];
  vec3 c = vec3(0.0);
  if (what == kViewId) c = hashColour(g.nearest);
  if (what == kViewNormal) c = 0.5 + 0.5 * texelFetch(records, int(kRecordTexels * g.nearest + 1u)).xyz;
  if (what == kViewAge) c = heat(float(frame.frame - sites[g.nearest].birth) / kAgeScale);
  if (what == kViewInconsistency) c = heat(s.inconsistency);
  if (what == kViewRays) c = heat(float(s.rays) / kRayScale);
  if (what == kViewRadiance) return s.mean;
  return g.nearestWeight < kRim ? kDim * c : c;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  const vec4 place = imageLoad(position, pixel);
  vec3 colour = vec3(0.0);
  if (place.w != 0.0) colour = colourOf(place.xyz, imageLoad(geometricNormal, pixel).xyz, imageLoad(irradiance, pixel).w);
  imageStore(result, pixel, vec4(colour, 1.0));
}
