#ifndef HALFLIGHT_DDGI_GRID_H
#define HALFLIGHT_DDGI_GRID_H
// What C++ and shaders agree on about the probes.
#include "shaders/shared/interop.h"
HL_BEGIN

/// The lattice, as a uniform block.
struct DdgiGrid {
  vec3 first;           ///< where probe (0, 0, 0) stands before relocation
  float leastSpacing;   ///< the smallest of the three: biases are shares of it
  vec3 spacing;         ///< [m]
  float farthest;       ///< plain distances are cut here [m]
  uvec3 counts;
  uint tilesAcross;     ///< probes in a row of the atlases
};

/// Push constants of passes over some of the probes. Ray j of probe `firstProbe` + i is ray i * rays + j.
struct DdgiBatch {
  uint firstProbe;
  uint probes;
  uint rays;    ///< of each probe
  uint seed;
  uint frame;
  uint placing;      ///< kCasting..., below
  uint startFrames;  ///< without history
};

HL_CONST uint kCastingLight = 0u;
HL_CONST uint kCastingFixed = 1u;   ///< the unrotated rays that relocation and classification go by, of all probes
HL_CONST uint kCastingAnew = 2u;    ///< the same, from the lattice and not from where probes have been moved to

/// Probe states, in w of the table of probes. Only active ones cast rays and are asked.
HL_CONST uint kProbeActive = 0u;
HL_CONST uint kProbeInside = 1u;    ///< sees the backs of one-sided surfaces
HL_CONST uint kProbeUnneeded = 2u;  ///< no surface in any of the cells round it

/// Rays of relocation and classification: the same in every frame, and no part of what is blended.
HL_CONST uint kFixedRays = 32u;
/// From the lattice they start this much behind the probe [spacings], so that one that stands in a wall's very plane sees the wall.
HL_CONST float kBacktrack = 0.01f;
// Weights of a probe (Majercik et al. 2019, section 5.2; 2021).
HL_CONST float kLeastTrilinear = 0.01f;    ///< so that the one probe that sees a point counts however far along the cell it stands (0.001 in the source)
HL_CONST float kFacingOffset = 0.2f;       ///< of ((cosine + 1) / 2)^2
HL_CONST float kProximityOffset = 0.01f;   ///< added to distances before their reciprocals are taken [spacings]: a surface that touches a probe is finitely near
HL_CONST float kLeastWeight = 0.000001f;   ///< likewise, before crushing: the sum of weights of active probes is never 0
HL_CONST float kCrushBelow = 0.2f;
HL_CONST float kChangedHistoryShare = 0.25f;  ///< of the history's weight where change_threshold is passed

/// Counters of the last frame.
HL_CONST uint kCountNan = 0u;               ///< texels of the maps of irradiance and distance
HL_CONST uint kCountInf = 1u;
HL_CONST uint kCountHitsWithoutProbe = 2u;  ///< no active probe round them
HL_CONST uint kCountPixelsWithoutProbe = 3u;
HL_CONST uint kDdgiCounters = 4u;

/// How one of the eight probes round a point counts, for people.
struct DdgiProbeWeight {
  vec3 position;
  float trilinear;
  vec3 irradiance;   ///< that it gives in the direction of the normal
  float facing;
  uvec3 at;          ///< in the lattice
  float visibility;
  uint state;
  float weight;      ///< the product, after crushing; not normalised
};

HL_INLINE uint probeIndex(uvec3 at, uvec3 counts) { return at.x + counts.x * (at.y + counts.y * at.z); }
HL_INLINE uvec3 probeAt(uint index, uvec3 counts) { return uvec3(index % counts.x, index / counts.x % counts.y, index / (counts.x * counts.y)); }

HL_END
#endif
