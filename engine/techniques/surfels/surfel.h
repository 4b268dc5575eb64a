#ifndef HALFLIGHT_SURFEL_H
#define HALFLIGHT_SURFEL_H
// What C++ and shaders agree on about surfels: their memory, a frame's constants, and the weight that one has at a point.
#include "engine/techniques/surfels/grid_cells.h"
#include "shaders/shared/interop.h"
#include "shaders/shared/sampling.h"
HL_BEGIN

HL_CONST uint kNoSurfel = 0xffffffffu;
HL_CONST uint kNoClaim = 0xffffffffu;
HL_CONST uint kClaimSlots = 65536u;

/// Where a surfel sits, in the rest pose of its object; written once, when it is placed.
struct Surfel {
  vec3 position;
  uint object;
  vec3 normal;  ///< unit, geometric
  uint birth;   ///< frame
};

/// What a surfel has learnt.
struct SurfelState {
  vec3 mean;             ///< irradiance [W/m^2]: what is shown
  float samples;         ///< frames with rays that it rests on; fewer again when the light changed
  vec3 shortMean;
  float inconsistency;   ///< smoothed |mean - short mean| in deviations
  vec3 variance;         ///< of one frame's sample
  float blendReduction;
  uint rays;             ///< cast since birth: index in its sequence
  uint lastUsed;         ///< frame in which a ray's hit looked it up
  uint lastSeen;         ///< frame in which a pixel did
  uint priority;         ///< low half: its part in ray_budget, 0: free; high half: rays beyond it, in 1/kYoungUnit
};

/// What look-ups read, three vec4 a surfel: world position and radius (0: free; negative: of one out of view, which reaches farther where rays land), world normal and
/// confidence, irradiance and 0.
HL_CONST uint kRecordTexels = 3u;

/// A ray's place in its surfel's sequence.
struct RaySample {
  uint surfel;   ///< kNoSurfel: not cast
  uint square;   ///< where in the unit square it fell, 16 bits each
  float weight;  ///< 1 / density on the square
};

/// A place where a surfel is wanted.
struct Candidate {
  vec3 position;
  uint claim;     ///< kNoClaim: none is wanted
  vec3 normal;
  uint triangle;
  vec3 seed;      ///< irradiance of the neighbours there
  float seedWeight;  ///< 0: there are none
};

/// Counters of one frame.
HL_CONST uint kCountNan = 0u;
HL_CONST uint kCountInf = 1u;
HL_CONST uint kCountUncoveredHits = 2u;    ///< no surfel reaches them
HL_CONST uint kCountUncoveredPixels = 3u;
HL_CONST uint kCountCellOverflows = 4u;
HL_CONST uint kCountMaxReached = 5u;
HL_CONST uint kCountPlacedPixels = 6u;
HL_CONST uint kCountPlacedHits = 7u;
HL_CONST uint kCountRecycled = 8u;
HL_CONST uint kCountFireflies = 9u;
HL_CONST uint kCountBlackHits = 10u;  ///< hits on what reflects nothing
HL_CONST uint kCountHits = 11u;       ///< on what reflects
HL_CONST uint kCountUpsampleMisses = 12u;
HL_CONST uint kCountUnlitHits = 13u;    ///< nothing near knows its light
HL_CONST uint kCountUnlitPixels = 14u;
HL_CONST uint kCountDroppedLists = 15u;  ///< lists that found no room: cells stay empty, tiles ask the grid
HL_CONST uint kSurfelCounters = 16u;

/// What outlives a frame.
struct SurfelTotals {
  uint stamp;        ///< 1 + the frame that wrote it
  uint highWater;    ///< surfels have numbers below this
  uint freeCount;    ///< numbers on the stack of free ones
  uint alive;
  uint priority;     ///< sum of this frame's priorities, for the next one
  uint lastPriority; ///< ... of the last frame's, for this one
  uint young;        ///< sum of what this frame's surfels want beyond ray_budget, for the next one, in 1/kYoungUnit
  uint lastYoung;
  uint entries;      ///< surfels in cells
  uint largestCell;
  uint largestTile;
  uint inView;       ///< of those alive, seen by a pixel lately
  uint counters[kSurfelCounters];
};

/// A frame's constants.
struct SurfelFrame {
  vec3 gridOrigin;
  float cellSize;
  uvec3 gridSize;
  uint cells;         ///< of the grid, whichever it is
  uint lists;         ///< cells, then tiles of the screen where these have lists
  uint entriesMost;   ///< room for surfels in lists
  GridShape grid;     ///< the camera's, and its regions
  GridRegion regions[kGridRegions];
  vec3 eye;
  vec3 forward;       ///< unit; then what gives the picture's coordinates in [-1, 1]: right.(p - eye) / forward.(p - eye)
  vec3 right;
  vec3 down;
  uint width;         ///< pixels
  uint height;
  float pixelAngle;   ///< a pixel's side at distance 1
  float radius;       ///< [m], sizing world
  float radiusMax;    ///< [m], sizing screen
  uint frame;
  uint seed;
  uint surfels;       ///< numbers in use: [0, surfels)
  uint maxSurfels;
  uint rays;          ///< of this frame
  uint tiles;
  uint tilesX;
  uint candidates;    ///< tiles, then rays
  float fill;         ///< alive surfels over max_surfels at the frame's start
  float diagonal;     ///< of the scene [m]
  uint frozen;        ///< 1: nothing is placed or removed
  uint justFrozen;    ///< 1: since this frame
  uint places;        ///< 1: surfels are placed and removed in this frame
  uint listed;        ///< 1: lists are made in this frame, else they are those of an earlier one
  uint lightChanged;  ///< 1: lights are not what they were
  uint still;         ///< frames before this one in a row in which nothing moved, and neither lights nor parameters changed
  uint casts;         ///< 1: rays are cast and estimates learn in this frame
  uint gathers;       ///< 1: pixels gather in this frame, else they keep what they have
  uint recent;        ///< frames a surfel counts as in view for
  float age;          ///< frames since the cache began, or since lights changed as many as change_samples
};

/// Nearer to the eye than this share of the largest radius no surfel shrinks.
HL_CONST float kLeastRadius = 1.0f / 64.0f;
HL_CONST uint kTilePixels = 16u;     ///< side of a placement tile
HL_CONST uint kSplatPixels = 8u;     ///< side of a tile that lists surfels
HL_CONST uint kShareUnit = 256u;     ///< of a ray, in which shares are counted
HL_CONST float kYoungUnit = 8.0f;    ///< so that 2^20 surfels times the largest young_rays fit a word
HL_CONST float kPriorityUnit = 64.0f;
HL_CONST uint kPriorityMask = 0xffffu;
HL_CONST uint kMaxPriority = 4095u;  ///< so that 2^20 of them fit a word
HL_CONST uint kDepthSide = 4u;
HL_CONST uint kGuideSide = 6u;
HL_CONST float kDepthRange = 2.0f;   ///< distances are remembered up to so many radii at least (the surfel's diameter), up to hit_reach where that is more
HL_CONST uint kRecentFrames = 4u;    ///< a surfel counts as in view for so long where pixels gather in every frame

HL_INLINE uint squareTo16(vec2 u) { return min(uint(u.x * 65536.0f), 65535u) | (min(uint(u.y * 65536.0f), 65535u) << 16u); }
HL_INLINE vec2 squareOf16(uint p) { return vec2((float(p & 65535u) + 0.5f) / 65536.0f, (float(p >> 16u) + 0.5f) / 65536.0f); }

/// The other way of sampleDisc: where in the unit square a point of the unit disc comes from.
HL_INLINE vec2 squareOfDisc(vec2 d) {
  float r = sqrt(d.x * d.x + d.y * d.y);
  if (r == 0.0f) return vec2(0.5f, 0.5f);
  vec2 s = vec2(0.0f, 0.0f);
  if (abs(d.x) > abs(d.y)) {
    float x = d.x > 0.0f ? r : -r;
    s = vec2(x, x * atan(d.y / d.x) / (0.25f * kPi));
  } else {
    float y = d.y > 0.0f ? r : -r;
    s = vec2(y * atan(d.x / d.y) / (0.25f * kPi), y);
  }
  return vec2(clamp(0.5f * s.x + 0.5f, 0.0f, 0.99999994f), clamp(0.5f * s.y + 0.5f, 0.0f, 0.99999994f));
}

HL_INLINE uint squareTexel(vec2 u, uint side) {
  return min(uint(u.y * float(side)), side - 1u) * side + min(uint(u.x * float(side)), side - 1u);
}

/// Smooth falloff 1 - 3 t^2 + 2 t^3 (Lehtinen et al. 2008) of the Mahalanobis distance over the radius, whose square is `t2`.
HL_INLINE float surfelFalloff(float t2) { return t2 < 1.0f ? 1.0f + t2 * (2.0f * sqrt(t2) - 3.0f) : 0.0f; }

/// Square of the distance of `toPoint` (from the surfel's centre) over its radius, with distances along the normal `squash` times as long.
HL_INLINE float surfelDistance2(vec3 toPoint, vec3 surfelNormal, float radius, float squash) {
  float along = dot(toPoint, surfelNormal);
  return (dot(toPoint, toPoint) + (squash * squash - 1.0f) * along * along) / (radius * radius);
}

/// The direction from a surfel to a point near its plane, as a texel of its map of distances.
HL_INLINE uint depthTexel(vec3 toPoint, vec3 surfelNormal) {
  vec3 t = vec3(0.0f);
  vec3 b = vec3(0.0f);
  orthonormalBasis(surfelNormal, t, b);
  vec2 across = vec2(dot(toPoint, t), dot(toPoint, b));
  float up = max(0.0f, dot(toPoint, surfelNormal));
  float lengthTo = sqrt(across.x * across.x + across.y * across.y + up * up);
  if (!(lengthTo > 0.0f)) return 0u;
  return squareTexel(squareOfDisc(vec2(across.x / lengthTo, across.y / lengthTo)), kDepthSide);
}

/// Nothing is known of a direction yet: it counts as open.
HL_CONST float kUnknownDepth = -1.0f;

/// How far away across its plane a surfel sees a point: what its map of distances keeps. A wall that stands on the plane is then as far for rays that meet it high
/// up as for those at its foot.
HL_INLINE float depthAcross(vec3 toPoint, vec3 surfelNormal) {
  float along = dot(toPoint, surfelNormal);
  return sqrt(max(0.0f, dot(toPoint, toPoint) - along * along));
}

/// Chebyshev's bound on the share of what is seen at `distance` or beyond (Donnelly and Lauritzen 2006), in radii; its third power, as usual, against what is left
/// of the other side's light just behind a wall (Majercik et al. 2019).
HL_INLINE float depthVisibility(vec2 moments, float distance, float softness) {
  if (moments.x < 0.0f || distance <= moments.x) return 1.0f;
  float variance = max(moments.y - moments.x * moments.x, softness * softness);
  float beyond = distance - moments.x;
  float bound = variance / (variance + beyond * beyond);
  return bound * bound * bound;
}

HL_END
#endif
