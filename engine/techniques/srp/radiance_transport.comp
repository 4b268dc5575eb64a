#version 460
#extension GL_GOOGLE_include_directive : require
// Radiance at receivers on glossy surfaces: as irradiance in transport.comp, a thread for each of its coefficients.
#include "engine/techniques/srp/hemisphere_basis.h"
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/matrix_page.glsl"
#include "shaders/shared/sampling.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;
layout(constant_id = 1) const bool kReads = false;

/// A read stands for several samples, and the direction to its lumel is no sample's own: it may be anywhere near the horizon.
const float kLeastReadHeight = 0.05;

layout(scalar) readonly buffer clusters_block { SrpCluster clusters[]; };
layout(scalar) readonly buffer vectors_block { vec4 vectors[]; };
layout(scalar) readonly buffer lumelOfReceiver_block { uint lumelOfReceiver[]; };
layout(scalar) writeonly buffer incident_block { vec3 incident[]; };     // wide receivers x coefficients
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };  // of lumels
layout(scalar) readonly buffer firstRead_block { uint firstRead[]; };    // receivers + 1
layout(scalar) readonly buffer reads_block { SrpRead reads[]; };
uniform samplerBuffer radiance;                                          // that lumels send out
layout(push_constant, scalar) uniform Constants { SrpPage batch; };

void main() {
  SrpCluster c = clusters[batch.first + gl_WorkGroupID.y];
  uint r = gl_GlobalInvocationID.x;
  uint index = gl_WorkGroupID.z;
  if (r >= c.wide) return;
  HemisphereTerm term = hemisphereTerm(int(index));
  uint row = c.receivers + index * c.wide + r;
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < c.rank; ++k) sum += entry(c.weights + k * c.rows + row) * vectors[c.firstVector + k].xyz;
  if (kReads) {
    SurfacePoint p = points[lumelOfReceiver[c.firstReceiver + r]];
    vec3 t, b;
    orthonormalBasis(p.geometricNormal, t, b);
    uint end = firstRead[c.firstReceiver + r + 1u];
    for (uint i = firstRead[c.firstReceiver + r]; i < end; ++i) {
      vec3 to = points[reads[i].lumel].position - p.position;
      vec3 w = to == vec3(0.0) ? p.geometricNormal : normalize(to);
      float factor = hemisphereFactor(term, dot(w, t), dot(w, b), dot(w, p.geometricNormal), kLeastReadHeight);
      sum += factor * reads[i].weight * texelFetch(radiance, int(reads[i].lumel)).xyz;
    }
  }
  incident[(c.firstWide + r) * gl_NumWorkGroups.z + index] = term.norm * sum;
}
