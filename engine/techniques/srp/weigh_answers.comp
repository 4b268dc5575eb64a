#version 460
#extension GL_GOOGLE_include_directive : require
// What each answer weighs in the transport kernel (equation 4.10), once for all rows that are summed of it: its probe's share over the sum of shares (weigh.comp), and over the share of surfaces that the
// probe sees round what the ray hit.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/probe_answer.glsl"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer surfaces_block { float surfaces[]; };       // probes x coefficients: which directions end on a surface, in spherical harmonics
layout(scalar) buffer shares_block { float shares[]; };
layout(scalar) buffer scales_block { float scales[]; };
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
  float scale = scales[r];
  for (uint q = 0u; q < unit.slots; ++q) {
    uint i = r * unit.slots + q;
    float share = shares[i];
    if (share == 0.0) continue;
    float w = scale > 0.0 ? share * scale : 0.0;
    if (w != 0.0 && unit.surfaceShare != 0u) {
      float surface = surfaceShare(r, i, near[(r / unit.samples) * unit.slots + q].probe);
      if (surface < kSrpLeastSurface) scales[r] = kSrpScarce;
      w /= max(surface, kSrpLeastSurface);
    }
    shares[i] = w;
  }
}
