#version 460
#extension GL_GOOGLE_include_directive : require
// Adds a unit's samples of the transport kernel to the cluster's matrix: one thread a receiver and probe, so that sums run in one order.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/sampling.h"
#include "shaders/shared/spherical_harmonics.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };     // of all receivers
layout(scalar) readonly buffer directional_block { vec2 directional[]; };   // directionalTable()
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer questions_block { Ray questions[]; };
layout(scalar) readonly buffer blocked_block { uint blocked[]; };
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) buffer matrix_block { float matrix[]; };  // rows x receivers x columns
layout(scalar) buffer valid_block { float valid[]; };    // samples a receiver that count
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

/// A sample's factors in a receiver's rows. Rays are cosine distributed, which the irradiance's own row has no more to say about; the others divide by it.
float factors[kSrpDirectionalRows];
void findFactors(vec3 direction, vec3 normal) {
  factors[0] = 1.0;
  if (unit.rows == 1u) return;
  vec3 t, b;
  orthonormalBasis(normal, t, b);
  vec3 w = vec3(dot(direction, t), dot(direction, b), dot(direction, normal));
  float height = clamp(w.z, 1e-3, 1.0);
  float at = height * float(directional.length() - 1);
  uint low = min(uint(at), uint(directional.length()) - 2u);
  vec2 slope = mix(directional[low], directional[low + 1u], at - float(low)) / height;
  float flat_ = length(w.xy);
  vec2 along = flat_ > 0.0 ? w.xy / flat_ : vec2(0.0);
  factors[1] = slope.x * along.x;
  factors[2] = slope.x * along.y;
  factors[3] = slope.y;
}

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
    if (scale <= 0.0 || questions[question].tMax < questions[question].tMin || blocked[question] != 0u) continue;
    // The corrected direction: from the probe to what the receiver sees; into the open it is the receiver's own.
    vec3 direction = questions[question].direction;
    if (hits[r].primitive != kMiss) direction = -normalize(direction);
    float w = n.weight * scale;
    findFactors(rays[r].direction, points[unit.firstReceiver + receiver].geometricNormal);
    for (ShWalk y = shBegin(unit.order, direction); !shDone(y); shNext(y)) {
      float value = w * shValue(y), mirrored = y.m > 0 ? w * shMirroredValue(y) : 0.0;
      for (uint row = 0u; row < unit.rows; ++row) {
        uint at = base + row * unit.receivers * unit.columns;
        matrix[at + uint(shIndex(y.l, y.m))] += factors[row] * value;
        if (y.m > 0) matrix[at + uint(shIndex(y.l, -y.m))] += factors[row] * mirrored;
      }
    }
  }
}
