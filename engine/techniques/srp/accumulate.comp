#version 460
#extension GL_GOOGLE_include_directive : require
// Adds a unit's samples of the transport kernel to the cluster's matrix: one thread a receiver and probe, so that sums run in one order.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/directional.glsl"
#include "engine/techniques/srp/probe_frame.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };     // of all receivers
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer questions_block { Ray questions[]; };
layout(scalar) readonly buffer shares_block { float shares[]; };
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) readonly buffer surfaces_block { float surfaces[]; };       // probes x coefficients: which directions end on a surface, in spherical harmonics
layout(scalar) buffer matrix_block { float matrix[]; };  // rows x receivers x columns
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
  float factors[kSrpDirectionalRows];  ///< of a sample in the receiver's rows
  uint base = receiver * unit.columns + n.column;
  vec4 toProbe = inverseRotation(probeFrame(unit.seed, n.probe));
  for (uint s = 0u; s < unit.samples; ++s) {
    uint r = receiver * unit.samples + s;
    uint question = r * unit.slots + q;
    float scale = scales[r];
    float share = shares[question];
    if (scale <= 0.0 || share == 0.0) continue;
    // The corrected direction: from the probe to what the receiver sees; into the open it is the receiver's own.
    vec3 direction = questions[question].direction;
    if (hits[r].primitive != kMiss) direction = -normalize(direction);
    if (unit.surfaceShare != 0u && hits[r].primitive == kMiss) continue;
    vec3 local = rotated(direction, toProbe);
    float w = share * scale;
    if (unit.surfaceShare != 0u) {
      float surface = 0.0;
      uint own = n.probe * uint(shCount(unit.order));
      for (ShWalk y = shBegin(unit.order, local); !shDone(y); shNext(y)) {
        surface += surfaces[own + uint(shIndex(y.l, y.m))] * shValue(y);
        if (y.m > 0) surface += surfaces[own + uint(shIndex(y.l, -y.m))] * shMirroredValue(y);
      }
      w /= max(surface, kSrpLeastSurface);
    }
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
