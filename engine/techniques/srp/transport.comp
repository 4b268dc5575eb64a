#version 460
#extension GL_GOOGLE_include_directive : require
// Irradiance at receivers: their weights times the cluster's light vector (equation 4.13), and what they read off surfaces that no probe sees.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/matrix_page.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 2) const bool kReads = false;

layout(scalar) readonly buffer clusters_block { SrpCluster clusters[]; };
layout(scalar) readonly buffer vectors_block { vec4 vectors[]; };
layout(scalar) readonly buffer lumelOfReceiver_block { uint lumelOfReceiver[]; };
layout(scalar) writeonly buffer irradiance_block { vec4 irradiance[]; };
layout(scalar) buffer counters_block { uint counters[]; };
layout(scalar) readonly buffer firstRead_block { uint firstRead[]; };  // receivers + 1
layout(scalar) readonly buffer reads_block { SrpRead reads[]; };
uniform samplerBuffer radiance;                                       // that lumels send out
layout(push_constant, scalar) uniform Constants { SrpPage batch; };

void main() {
  SrpCluster c = clusters[batch.first + gl_WorkGroupID.y];
  uint r = gl_GlobalInvocationID.x;
  if (r >= c.receivers) return;
  vec3 e = vec3(0.0);
  for (uint k = 0u; k < c.rank; ++k) e += entry(c.weights + k * c.receivers + r) * vectors[c.firstVector + k].xyz;
  if (kReads) {
    uint end = firstRead[c.firstReceiver + r + 1u];
    for (uint i = firstRead[c.firstReceiver + r]; i < end; ++i) e += reads[i].weight * texelFetch(radiance, int(reads[i].lumel)).xyz;
  }
  if (any(isnan(e)) || any(isinf(e))) atomicAdd(counters[kSrpNonFinite], 1u);
  else if (any(lessThan(e, vec3(0.0)))) atomicAdd(counters[kSrpNegative], 1u);
  if (batch.clampNegative != 0u) e = max(e, vec3(0.0));
  irradiance[lumelOfReceiver[c.firstReceiver + r]] = vec4(e, 0.0);
}
