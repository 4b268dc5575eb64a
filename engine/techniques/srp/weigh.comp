#version 460
#extension GL_GOOGLE_include_directive : require
// The transport kernel (equation 4.10) for each of a unit's rays: of each question, its probe's share over the sum of shares of all that see what the ray hit, and over the share of surfaces that the
// probe sees round there. Probes that do not see it lose their share. Once for all rows that are summed of it.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/probe_answer.glsl"
#include "shaders/shared/lumel_rays.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer blocked_block { uint blocked[]; };
layout(scalar) readonly buffer surfaces_block { float surfaces[]; };       // probes x coefficients: which directions end on a surface, in spherical harmonics
uniform samplerBuffer triangles;
layout(scalar) buffer shares_block { float shares[]; };
layout(scalar) writeonly buffer rayKinds_block { uint rayKinds[]; };
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

/// The share of surfaces round what the ray hit, in the probe's own order.
float surfaceShare(uint ray, uint question, uint probe) {
  vec3 local = askedDirection(ray, question, inverseRotation(probeFrame(unit.seed, probe)));
  float surface = 0.0;
  uint own = probe * uint(shCount(unit.order));
  for (ShWalk y = shBegin(unit.order, local); !shDone(y); shNext(y)) {
    surface += surfaces[own + uint(shIndex(y.l, y.m))] * shValue(y);
    if (y.m > 0) surface += surfaces[own + uint(shIndex(y.l, -y.m))] * shMirroredValue(y);
  }
  return surface;
}

void main() {
  uint r = gl_GlobalInvocationID.x;
  if (r >= unit.receivers * unit.samples) return;
  uint first = r * unit.slots;
  float sum = 0.0;
  bool coarse = false;
  for (uint q = 0u; q < unit.slots; ++q) {
    float share = shares[first + q];
    if (share == 0.0) continue;
    bool sees = blocked[first + q] == 0u;
    if (sees && share > 0.0) sum += share;
    else shares[first + q] = 0.0;
    coarse = coarse || (sees && share < 0.0);
  }
  Hit hit = hits[r];
  uint kind = sum > 0.0 ? kSrpAnswered : (coarse ? kSrpCoarse : kSrpInvalid);
  if (hit.primitive == kMiss) {
    if (unit.environment != 0u && unit.surfaceShare != 0u) kind = kSrpDark;  // what is not reflected there needs no probe to be known
  } else if (hitsBack(texelFetch(triangles, int(2u * hit.primitive + 1u)), rays[r].direction)) {
    kind = kSrpDark;
  }
  float scale = 1.0 / sum;
  for (uint q = 0u; q < unit.slots && sum > 0.0; ++q) {
    uint i = first + q;
    float share = shares[i];
    if (share == 0.0) continue;
    float w = kind == kSrpDark ? 0.0 : share * scale;
    if (w != 0.0 && unit.surfaceShare != 0u) {
      float surface = surfaceShare(r, i, near[(r / unit.samples) * unit.slots + q].probe);
      if (surface < kSrpLeastSurface) kind = kSrpScarce;
      w /= max(surface, kSrpLeastSurface);
    }
    shares[i] = w;
  }
  rayKinds[r] = kind;
}
