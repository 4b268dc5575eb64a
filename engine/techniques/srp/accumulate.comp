#version 460
#extension GL_GOOGLE_include_directive : require
// Adds a unit's samples of the transport kernel to the cluster's matrix: one thread a receiver and probe, so that sums run in one order.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer questions_block { Ray questions[]; };
layout(scalar) readonly buffer shares_block { float shares[]; };
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) buffer matrix_block { float matrix[]; };  // receivers x columns
layout(scalar) buffer valid_block { float valid[]; };    // samples a receiver that count
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= unit.receivers * unit.slots) return;
  uint receiver = i / unit.slots;
  uint q = i % unit.slots;
  SrpNear n = near[i];
  if (q == 0u) {
    float count = 0.0;
    for (uint s = 0u; s < unit.samples; ++s)
      if (scales[receiver * unit.samples + s] != kSrpInvalid) count += 1.0;
    valid[receiver] += count;
  }
  if (!(n.weight > 0.0)) return;
  uint base = receiver * unit.columns + n.column;
  for (uint s = 0u; s < unit.samples; ++s) {
    uint r = receiver * unit.samples + s;
    uint question = r * unit.slots + q;
    float scale = scales[r];
    float share = shares[question];
    if (scale <= 0.0 || share == 0.0) continue;
    // The corrected direction: from the probe to what the receiver sees; into the open it is the receiver's own.
    vec3 direction = questions[question].direction;
    if (hits[r].primitive != kMiss) direction = -normalize(direction);
    float w = share * scale;
    for (ShWalk y = shBegin(unit.order, direction); !shDone(y); shNext(y)) {
      matrix[base + uint(shIndex(y.l, y.m))] += w * shValue(y);
      if (y.m > 0) matrix[base + uint(shIndex(y.l, -y.m))] += w * shMirroredValue(y);
    }
  }
}
