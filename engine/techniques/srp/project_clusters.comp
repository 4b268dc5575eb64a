#version 460
#extension GL_GOOGLE_include_directive : require
// A cluster's light vector: its basis times the radiance of its probes (section 4.5.2). One workgroup an entry. Without compression there is no basis, and the
// vector is the probes' radiance itself.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/matrix_page.glsl"

const uint kLanes = 64u;
layout(local_size_x = 64) in;
layout(constant_id = 1) const bool kCompressed = true;

layout(scalar) readonly buffer clusters_block { SrpCluster clusters[]; };
layout(scalar) readonly buffer clusterProbes_block { uint clusterProbes[]; };
layout(scalar) readonly buffer coefficients_block { vec4 coefficients[]; };
layout(scalar) writeonly buffer vectors_block { vec4 vectors[]; };
layout(push_constant, scalar) uniform Constants { SrpPage batch; };

shared vec3 parts[kLanes];

vec3 radianceOf(SrpCluster c, uint column) {
  uint probe = clusterProbes[c.firstProbe + column / batch.coefficients];
  return coefficients[probe * batch.coefficients + column % batch.coefficients].xyz;
}

void main() {
  SrpCluster c = clusters[batch.first + gl_WorkGroupID.y];
  uint lane = gl_LocalInvocationIndex;
  if (!kCompressed) {
    uint i = gl_GlobalInvocationID.x;
    if (i < c.rank) vectors[c.firstVector + i] = vec4(radianceOf(c, i), 0.0);
    return;
  }
  uint k = gl_WorkGroupID.x;
  vec3 sum = vec3(0.0);
  uint columns = c.probes * batch.coefficients;
  if (k < c.rank)
    for (uint i = lane; i < columns; i += kLanes) sum += entry(c.basis + k * columns + i) * radianceOf(c, i);
  parts[lane] = sum;
  barrier();
  for (uint half_ = kLanes / 2u; half_ > 0u; half_ >>= 1u) {
    if (lane < half_) parts[lane] += parts[lane + half_];
    barrier();
  }
  if (lane == 0u && k < c.rank) vectors[c.firstVector + k] = vec4(parts[0], 0.0);
}
