#ifndef HALFLIGHT_SRP_UNIT_H
#define HALFLIGHT_SRP_UNIT_H
// What C++ and the shaders agree on: a unit of precomputation, and the matrices of a frame.
#include "shaders/shared/interop.h"
HL_BEGIN

/// One of the probes that a receiver asks.
struct SrpNear {
  uint probe;     ///< of all
  uint column;    ///< first of its columns in the cluster's matrix
  float weight;   ///< w of equation 4.4; 0: the slot is empty
};

/// Push constants of precomputation: samples [firstSample, firstSample + samples) of one cluster's receivers. Ray r * samples + s; its question to the
/// probe in slot q is ray (r * samples + s) * slots + q.
struct SrpUnit {
  uint firstReceiver;
  uint receivers;
  uint firstSample;
  uint samples;
  uint slots;
  uint columns;
  uint seed;
  uint environment;   ///< 1: rays into the open ask too
  int order;
  float offset;       ///< of rays that start at a hit, in front of it [m]
  uint rows;          ///< a wide receiver, in the sums of accumulate.comp: 1, or kSrpDirectionalRows
  uint solidAngle;    ///< 1: probes share by the solid angle of what was hit too
  uint surfaceShare;  ///< 1: what a probe says is divided by the share of surfaces there
  float blurLimit;    ///< a probe is asked for what it blurs over at most so many lengths of the receiver's ray; 0: for all
  uint reads;         ///< strata of a receiver's samples; 0: what no probe sees is not read
  uint allSamples;    ///< of a receiver, in all units
  uint resolution;    ///< of the lightmap
  uint wide;          ///< the first receivers, so many, have all rows; the others one
  uint everySample;   ///< 1: samples that no probe sees count too, as read off surfaces or as dark
};

/// Rows of the matrix that a directional receiver has: its irradiance, and the three parts of irradiance's change with the normal, in the frame that
/// orthonormalBasis gives for its own. All receivers' first rows come first, then the second ones of those that have them, which are the cluster's first.
/// A radiance receiver on a glossy surface has its irradiance and coefficients of radiance (hemisphere_basis.h) in that frame.
HL_CONST uint kSrpDirectionalRows = 4u;

/// A ray's entry in what weigh.comp leaves: 1 / sum of the weights of the probes that see what it hit; or one of these.
HL_CONST float kSrpInvalid = 0.0f;   ///< no probe does
HL_CONST float kSrpDark = -1.0f;     ///< it hit what reflects nothing: valid, and dark
HL_CONST float kSrpCoarse = -2.0f;   ///< probes see it, and blur too much: valid, and read off the lightmap
HL_CONST float kSrpScarce = -3.0f;   ///< after weigh_answers.comp: probes answer, of which one at least sees so few surfaces there that kSrpLeastSurface holds

/// How many of a receiver's samples are coarse, and scarce.
struct SrpTally {
  uint coarse;
  uint scarce;
};

/// What a probe says is divided by the share of surfaces round there, but by no less than this: there hardly any is, and rays hit little of it.
HL_CONST float kSrpLeastSurface = 0.25f;

/// One stratum of a receiver's samples: one of those that no probe sees, each as likely as any other, and how many it stands for.
struct SrpStratum {
  uint lumel;
  uint count;
};

/// What a receiver reads off the lightmap: irradiance is weight times the lumel's radiance [sr].
struct SrpRead {
  uint lumel;
  float weight;
};

/// Samples of a probe that one workgroup projects.
HL_CONST uint kSrpPartSamples = 128u;

/// Push constants of probe projection: probes first, first + stride, ... of all, `count` of them, each in so many parts.
struct SrpTurn {
  uint first;
  uint stride;
  uint count;
  uint parts;
};

/// A cluster in a frame. Its matrices lie in one page; offsets there are in numbers, not bytes.
struct SrpCluster {
  uint firstReceiver;
  uint receivers;
  uint firstProbe;    ///< in the list of clusters' probes
  uint probes;
  uint rank;          ///< entries of its light vector
  uint firstVector;   ///< in the buffer of light vectors
  uint basis;         ///< rank x (probes * coefficients), rows after each other
  uint weights;       ///< rank x rows: all receivers' first rows, then the second ones of those that have them
  uint rows;          ///< of all receivers together
  uint wide;          ///< the first receivers, so many, have more than one
  uint firstWide;     ///< wide receivers in clusters before
};

/// Push constants of a frame's matrix passes: clusters [first, first + count), which share a page.
struct SrpPage {
  uint first;
  uint count;
  uint coefficients;
  uint clampNegative;
};

/// Counters of a frame.
HL_CONST uint kSrpNegative = 0u;     ///< receivers with a negative channel
HL_CONST uint kSrpNonFinite = 1u;
HL_CONST uint kSrpCounters = 2u;

/// Counters of what the camera sees reflected.
HL_CONST uint kSrpReflectedNegative = 0u;   ///< pixels with a negative channel, before any clamp
HL_CONST uint kSrpReflectedNonFinite = 1u;
HL_CONST uint kSrpReflectedNoTexel = 2u;    ///< glossy pixels without a glossy receiver
HL_CONST uint kSrpReflectedCounters = 3u;

/// Push constants of reflect.comp.
struct SrpReflect {
  vec3 eye;
  uint samples;        ///< of a pixel's lobe
  uint clampNegative;
};

HL_END
#endif
