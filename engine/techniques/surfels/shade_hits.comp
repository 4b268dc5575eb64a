#version 460
#extension GL_GOOGLE_include_directive : require
// What comes back along each ray: albedo / pi (direct light + what surfels at the hit know). Hits without a surfel near ask for one.
#define HL_SURFELS_LOOKUP
#define HL_SURFELS_STATES
#define HL_SURFELS_TOTALS
#define HL_SURFELS_CLAIMS
#include "engine/techniques/surfels/cache.glsl"
#include "shaders/passes/hit_surfaces.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer samples_block { RaySample samples[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
layout(scalar) readonly buffer albedo_block { vec4 albedo[]; };
layout(scalar) readonly buffer direct_block { vec4 direct[]; };
layout(scalar) writeonly buffer arrivals_block { vec4 arrivals[]; };  // radiance over density, distance; distance below 0: no sample

const float kFar = 1e30;

void main() {
  const uint ray = gl_GlobalInvocationID.x;
  if (ray >= frame.rays) return;
  const uint wanted = frame.tiles + ray;
  const RaySample s = samples[ray];
  const Hit hit = hits[ray];
  bool wants = false;
  vec4 arrival = vec4(0.0, 0.0, 0.0, s.surfel == kNoSurfel ? -1.0 : hit.primitive == kMiss ? kFar : hit.t);
  const SurfacePoint point = points[ray];
  if (s.surfel != kNoSurfel && point.flags == kHitSurface) {
    const vec3 reflectance = albedo[ray].xyz;
    if (max(reflectance.x, max(reflectance.y, reflectance.z)) > 0.0) {
      const Gathered g = gatherAt(point.position, point.geometricNormal, true);
      countOne(kCountHits);
      if (g.coverage <= 0.0) countOne(kCountUncoveredHits);
      if (g.weight <= 0.0) countOne(kCountUnlitHits);
      if (g.nearest != kNoSurfel) states[g.nearest].lastUsed = frame.frame;
      if (surfels.spawn_at_hits != 0 && frame.places != 0u && g.coverage < surfels.hit_coverage) {
        propose(wanted, point.position, point.geometricNormal, point.triangle, g.irradiance, g.weight);
        wants = true;
      }
      const vec4 sum = direct[ray];
      const vec3 reflected = reflectance * ((sum.w > 0.0 ? sum.xyz / sum.w : vec3(0.0)) + g.irradiance) / kPi * s.weight;
      if (isNotFinite(reflected)) {
        countOne(isNan(reflected) ? kCountNan : kCountInf);
        arrival.w = -1.0;
      } else {
        arrival.xyz = reflected;
      }
    } else {
      countOne(kCountBlackHits);
    }
  }
  if (!wants && frame.places != 0u) proposeNothing(wanted);
  arrivals[ray] = arrival;
}
