#ifndef HALFLIGHT_SURFEL_CACHE_GLSL
#define HALFLIGHT_SURFEL_CACHE_GLSL
// The cache as shaders see it. A shader declares what it will bind and nothing more: before the include it defines those of
//   HL_SURFELS_LOOKUP   records (read), cellOffsets, cellEntries, depthMoments (read): look-ups at points
//   HL_SURFELS_RECORDS  records, to be written
//   HL_SURFELS_STATES   states
//   HL_SURFELS_TOTALS   totals
//   HL_SURFELS_CLAIMS   claims, candidates
#include "shaders/shared/params.glsl"
#include "engine/techniques/surfels/params.inl"
#include "engine/techniques/surfels/surfel.h"

layout(scalar) uniform frame_block { SurfelFrame frame; };

#ifdef HL_SURFELS_TOTALS
layout(scalar) buffer totals_block { SurfelTotals totals; };
void countOne(uint which) { atomicAdd(totals.counters[which], 1u); }
#endif

#ifdef HL_SURFELS_STATES
layout(scalar) buffer states_block { SurfelState states[]; };
/// Whether a surfel counts as in view.
bool seenLately(uint lastSeen) { return frame.frame - lastSeen <= frame.recent; }
#endif

#ifdef HL_SURFELS_RECORDS
layout(scalar) buffer records_block { vec4 records[]; };
#endif

bool isNotFinite(float v) { return (floatBitsToUint(v) & 0x7f800000u) == 0x7f800000u; }
bool isNotFinite(vec3 v) { return isNotFinite(v.x) || isNotFinite(v.y) || isNotFinite(v.z); }
bool isNan(float v) { return (floatBitsToUint(v) & 0x7fffffffu) > 0x7f800000u; }
bool isNan(vec3 v) { return isNan(v.x) || isNan(v.y) || isNan(v.z); }
float luminanceOf(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// ---------------------------------------------------------------------------------------------------------------- the grid

layout(constant_id = 10) const bool kCameraGrid = false;

uint cellIndex(uvec3 c, uvec3 size) { return (c.z * size.y + c.y) * size.x + c.x; }
uvec3 cellWithin(vec3 coordinates, uvec3 size) { return uvec3(clamp(ivec3(floor(coordinates)), ivec3(0), ivec3(size) - 1)); }

/// The cell of any point; those outside the scene's bounds belong to cells at their rim.
uint cellAt(vec3 p) {
  if (!kCameraGrid) return cellIndex(cellWithin((p - frame.gridOrigin) / frame.cellSize, frame.gridSize), frame.gridSize);
  const vec3 q = p - frame.eye;
  const uint region = gridRegionOf(q, frame.grid);
  const GridRegion r = frame.regions[region];
  return r.firstCell + cellIndex(cellWithin(gridCoordinates(q, region, frame.grid) - r.low, r.size), r.size);
}

float radiusAt(vec3 position) {
  if (surfels.sizing != kSizingScreen) return frame.radius;
  return clamp(surfels.radius_pixels * frame.pixelAngle * distance(position, frame.eye), kLeastRadius * frame.radiusMax, frame.radiusMax);
}

/// How far a surfel lights where rays land: one out of view farther, but never beyond radius_max, by which far surfels are bounded already.
float hitRadiusOf(float radius) { return max(radius, min(surfels.hit_reach * radius, frame.radiusMax)); }
/// The same from what a record has for its radius.
float reachOf(float signedRadius) { return signedRadius < 0.0 ? hitRadiusOf(-signedRadius) : signedRadius; }

// ---------------------------------------------------------------------------------------------------------------- look-ups

#ifdef HL_SURFELS_LOOKUP
layout(constant_id = 0) const bool kDepthTest = false;

uniform samplerBuffer records;
layout(scalar) readonly buffer cell_offsets { uint cellOffsets[]; };
layout(scalar) readonly buffer cell_entries { uint cellEntries[]; };
layout(scalar) readonly buffer depth_moments { vec2 depthMoments[]; };

/// The list of a cell or tile in cellEntries; false: there was no room for it.
bool listOf(uint list, out uint first, out uint end) {
  first = cellOffsets[list];
  end = cellOffsets[list + 1u];
  if (end <= frame.entriesMost) return true;
  end = first;
  return false;
}
void cellList(uint cell, out uint first, out uint end) {
  listOf(cell, first, end);
  end = min(end, first + uint(surfels.cell_limit));
}

const uint kAhead = 4u;  ///< entries of a list that are read at once

struct Gathered {
  vec3 irradiance;      ///< weighted mean; 0 where nothing is near
  float weight;         ///< of surfels that know their light
  float coverage;       ///< of all
  uint nearest;         ///< the surfel of the largest weight
  float nearestWeight;
};

/// `atHit`: with the reach it has where rays land.
float surfelWeight(vec3 p, vec3 n, bool atHit, uint id, vec4 placeRadius, vec3 surfelNormal) {
  if (placeRadius.w == 0.0) return 0.0;
  const float radius = abs(placeRadius.w);
  const vec3 to = p - placeRadius.xyz;
  const float t2 = surfelDistance2(to, surfelNormal, atHit ? reachOf(placeRadius.w) : radius, surfels.normal_squash);
  if (t2 >= 1.0) return 0.0;
  float weight = surfelFalloff(t2) * max(0.0, dot(n, surfelNormal));
  if (kDepthTest && weight > 0.0) {
    const vec2 moments = depthMoments[id * kDepthSide * kDepthSide + depthTexel(to, surfelNormal)];
    weight *= depthVisibility(moments, depthAcross(to, surfelNormal) / radius, surfels.depth_softness);
  }
  return weight;
}

/// The cell's surfels that face the same way, whatever their distance, the nearer the more.
void fillGap(vec3 p, vec3 n, uint first, uint end, inout Gathered g) {
  const float softening = 1e-4 * frame.cellSize * frame.cellSize;
  for (uint e = first; e < end; ++e) {
    const uint id = cellEntries[e];
    const vec4 place = texelFetch(records, int(kRecordTexels * id));
    const vec4 normal = texelFetch(records, int(kRecordTexels * id + 1u));
    const float facing = dot(n, normal.xyz);
    if (place.w == 0.0 || facing <= 0.0 || normal.w <= 0.0) continue;
    const vec3 to = p - place.xyz;
    const float along = dot(to, normal.xyz);
    const float d2 = (dot(to, to) + (surfels.normal_squash * surfels.normal_squash - 1.0) * along * along) + softening;
    const float weight = normal.w * facing * frame.cellSize * frame.cellSize / d2;
    g.weight += weight;
    g.irradiance += weight * texelFetch(records, int(kRecordTexels * id + 2u)).xyz;
  }
  if (g.weight > 0.0) g.irradiance /= g.weight;
}

/// In the order of the list, which is that of numbers: the same sum in every run, and from every list that has all that reach the point. Reads go a few entries
/// ahead, so that on a GPU a long list does not wait for memory once an entry.
Gathered gatherFrom(vec3 p, vec3 n, bool atHit, uint first, uint end) {
  Gathered g = Gathered(vec3(0.0), 0.0, 0.0, kNoSurfel, 0.0);
  for (uint e = first; e < end; e += kAhead) {
    uint ids[kAhead];
    vec4 places[kAhead], normals[kAhead];
    for (uint k = 0u; k < kAhead; ++k) ids[k] = cellEntries[min(e + k, end - 1u)];
    for (uint k = 0u; k < kAhead; ++k) {
      places[k] = texelFetch(records, int(kRecordTexels * ids[k]));
      normals[k] = texelFetch(records, int(kRecordTexels * ids[k] + 1u));
    }
    for (uint k = 0u; k < kAhead; ++k) {
      if (e + k >= end) break;
      const float weight = surfelWeight(p, n, atHit, ids[k], places[k], normals[k].xyz);
      if (weight <= 0.0) continue;
      g.coverage += weight;
      if (weight > g.nearestWeight) g.nearest = ids[k], g.nearestWeight = weight;
      const float known = weight * normals[k].w;
      if (known <= 0.0) continue;
      g.weight += known;
      g.irradiance += known * texelFetch(records, int(kRecordTexels * ids[k] + 2u)).xyz;
    }
  }
  if (g.weight > 0.0) g.irradiance /= g.weight;
  return g;
}

Gathered gatherAt(vec3 p, vec3 n, bool atHit) {
  uint first, end;
  cellList(cellAt(p), first, end);
  Gathered g = gatherFrom(p, n, atHit, first, end);
  if (g.weight <= 0.0 && surfels.fill_gaps != 0) fillGap(p, n, first, end, g);
  return g;
}
#endif

// ---------------------------------------------------------------------------------------------------------------- new surfels

#ifdef HL_SURFELS_CLAIMS
layout(scalar) buffer claims_block { uint claims[]; };
layout(scalar) buffer candidates_block { Candidate candidates[]; };

/// A slot for each cube of about a surfel's diameter; cubes that share one by chance wait for each other.
uint claimOf(vec3 position) {
  const float side = frame.diagonal * exp2(ceil(log2(2.0 * radiusAt(position) / frame.diagonal)));  // neighbours at slightly different distances mean the same cube
  const ivec3 cube = ivec3(floor((position - frame.gridOrigin) / side));
  return pcgHash(uint(cube.x) ^ pcgHash(uint(cube.y) ^ pcgHash(uint(cube.z)))) & (kClaimSlots - 1u);
}

void propose(uint index, vec3 position, vec3 normal, uint triangle, vec3 seed, float seedWeight) {
  const uint claim = claimOf(position);
  candidates[index] = Candidate(position, claim, normal, triangle, seed, seedWeight);
  atomicMin(claims[claim], index);
}
void proposeNothing(uint index) { candidates[index].claim = kNoClaim; }
#endif

/// Where a surfel's share of the rays begins, from the running sum of shares: so all are handed out, and each gets its share on average over frames.
uint firstRay(uint shareSum) { return min((shareSum + (pcgHash(frame.seed ^ pcgHash(frame.frame)) & (kShareUnit - 1u))) / kShareUnit, frame.rays); }
#endif
