#version 460
#extension GL_GOOGLE_include_directive : require
// Adds a unit's samples to the rows of radiance of a cluster's glossy receivers: one thread a receiver, probe and row, so that sums run in one order.
#include "engine/techniques/srp/hemisphere_basis.h"
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/probe_answer.glsl"
#include "shaders/shared/sampling.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };     // of all receivers
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) readonly buffer shares_block { float shares[]; };          // weights of answers; 0: none
layout(scalar) buffer matrix_block { float matrix[]; };  // rows x columns
layout(scalar) buffer moments_block { float moments[]; };  // wide receivers x rows of radiance: sums of factors alone
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  uint row = gl_WorkGroupID.y;  // of radiance
  if (i >= unit.wide * unit.slots) return;
  uint receiver = i / unit.slots;
  uint q = i % unit.slots;
  SrpNear n = near[i];
  HemisphereTerm term = hemisphereTerm(int(row));
  vec3 normal = points[unit.firstReceiver + receiver].geometricNormal;
  vec3 t, b;
  orthonormalBasis(normal, t, b);
  // Of N stratified samples the lowest is at 1 / sqrt(N).
  float least = inversesqrt(float(unit.allSamples));
  if (q == 0u) {
    uint at = receiver * gl_NumWorkGroups.y + row;
    float sum = moments[at];  // sample after sample, whatever units they come in
    for (uint s = 0u; s < unit.samples; ++s) {
      uint r = receiver * unit.samples + s;
      vec3 own = rays[r].direction;
      if (unit.everySample != 0u || scales[r] != kSrpInvalid) sum += hemisphereFactor(term, dot(own, t), dot(own, b), dot(own, normal), least);
    }
    moments[at] = sum;
  }
  if (!(n.weight > 0.0)) return;
  vec4 toProbe = inverseRotation(probeFrame(unit.seed, n.probe));
  uint base = (unit.receivers + row * unit.wide + receiver) * unit.columns + n.column;
  for (uint s = 0u; s < unit.samples; ++s) {
    uint r = receiver * unit.samples + s;
    uint question = r * unit.slots + q;
    float w = shares[question];
    if (w == 0.0) continue;
    vec3 local = askedDirection(r, question, toProbe);
    vec3 own = rays[r].direction;
    w *= hemisphereFactor(term, dot(own, t), dot(own, b), dot(own, normal), least);
    for (ShWalk y = shBegin(unit.order, local); !shDone(y); shNext(y)) {
      matrix[base + uint(shIndex(y.l, y.m))] += w * shValue(y);
      if (y.m > 0) matrix[base + uint(shIndex(y.l, -y.m))] += w * shMirroredValue(y);
    }
  }
}
