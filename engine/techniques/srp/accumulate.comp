#version 460
#extension GL_GOOGLE_include_directive : require
// Adds a unit's samples of the transport kernel to the cluster's matrix: one thread a receiver and probe, so that sums run in one order.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/directional.glsl"
#include "engine/techniques/srp/probe_answer.glsl"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };     // of all receivers
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) buffer matrix_block { float matrix[]; };  // rows x receivers x columns
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) readonly buffer shares_block { float shares[]; };          // weights of answers; 0: none
layout(scalar) buffer valid_block { float valid[]; };    // samples a receiver that count
layout(scalar) buffer tallies_block { SrpTally tallies[]; };
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= unit.receivers * unit.slots) return;
  uint receiver = i / unit.slots;
  uint q = i % unit.slots;
  SrpNear n = near[i];
  if (q == 0u) {
    float count = 0.0;
    SrpTally tally = tallies[receiver];
    for (uint s = 0u; s < unit.samples; ++s) {
      float kind = scales[receiver * unit.samples + s];
      if (kind != kSrpInvalid) count += 1.0;
      if (kind == kSrpCoarse) ++tally.coarse;
      if (kind == kSrpScarce) ++tally.scarce;
    }
    valid[receiver] += count;
    tallies[receiver] = tally;
  }
  if (!(n.weight > 0.0)) return;
  float factors[kSrpDirectionalRows];  ///< of a sample in the receiver's rows
  uint base = receiver * unit.columns + n.column;
  vec4 toProbe = inverseRotation(probeFrame(unit.seed, n.probe));
  for (uint s = 0u; s < unit.samples; ++s) {
    uint r = receiver * unit.samples + s;
    uint question = r * unit.slots + q;
    float w = shares[question];
    if (w == 0.0) continue;
    vec3 local = askedDirection(r, question, toProbe);
    factors[0] = 1.0;
    if (unit.rows > 1u) {
      vec3 more = directionalFactors(rays[r].direction, points[unit.firstReceiver + receiver].geometricNormal, inversesqrt(float(unit.allSamples)));
      factors[1] = more.x, factors[2] = more.y, factors[3] = more.z;
    }
    for (ShWalk y = shBegin(unit.order, local); !shDone(y); shNext(y)) {
      float value = w * shValue(y), mirrored = y.m > 0 ? w * shMirroredValue(y) : 0.0;
      for (uint row = 0u; row < unit.rows; ++row) {
        uint at = base + row * unit.receivers * unit.columns;
        matrix[at + uint(shIndex(y.l, y.m))] += factors[row] * value;
        if (y.m > 0) matrix[at + uint(shIndex(y.l, -y.m))] += factors[row] * mirrored;
      }
    }
  }
}
