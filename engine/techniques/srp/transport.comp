#version 460
#extension GL_GOOGLE_include_directive : require
// Irradiance at receivers: their weights times the cluster's light vector (equation 4.13), and what they read off surfaces that no probe sees.
#include "engine/techniques/srp/unit.h"
#include "engine/techniques/srp/directional.glsl"
#include "engine/techniques/srp/matrix_page.glsl"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;
layout(constant_id = 1) const bool kDirectional = false;
layout(constant_id = 2) const bool kReads = false;

/// A read stands for several samples, and the direction to its lumel is no sample's own: it may be anywhere near the horizon.
const float kLeastReadHeight = 0.2;

layout(scalar) readonly buffer clusters_block { SrpCluster clusters[]; };
layout(scalar) readonly buffer vectors_block { vec4 vectors[]; };
layout(scalar) readonly buffer lumelOfReceiver_block { uint lumelOfReceiver[]; };
layout(scalar) writeonly buffer irradiance_block { vec4 irradiance[]; };
layout(scalar) buffer counters_block { uint counters[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };  // of lumels
layout(scalar) writeonly buffer slopes_block { vec4 slopes[]; };         // of red, green and blue, then the constants: 4 x lumels
layout(scalar) readonly buffer firstRead_block { uint firstRead[]; };  // receivers + 1
layout(scalar) readonly buffer reads_block { SrpRead reads[]; };
uniform samplerBuffer radiance;                                       // that lumels send out
layout(push_constant, scalar) uniform Constants { SrpPage batch; };

/// What row `row` of the cluster's receiver r says of the light.
vec3 transported(SrpCluster c, uint row, uint r) {
  vec3 sum = vec3(0.0);
  for (uint k = 0u; k < c.rank; ++k) sum += entry(c.weights + k * c.rows + row * c.receivers + r) * vectors[c.firstVector + k].xyz;
  return sum;
}

void main() {
  SrpCluster c = clusters[batch.first + gl_WorkGroupID.y];
  uint r = gl_GlobalInvocationID.x;
  if (r >= c.receivers) return;
  vec3 e = transported(c, 0u, r);
  uint lumel = lumelOfReceiver[c.firstReceiver + r];
  vec3 n = points[lumel].geometricNormal;
  vec3 x = vec3(0.0), y = vec3(0.0), z = vec3(0.0);
  if (kDirectional) x = transported(c, 1u, r), y = transported(c, 2u, r), z = transported(c, 3u, r);
  if (kReads) {
    uint end = firstRead[c.firstReceiver + r + 1u];
    for (uint i = firstRead[c.firstReceiver + r]; i < end; ++i) {
      vec3 read = reads[i].weight * texelFetch(radiance, int(reads[i].lumel)).xyz;
      e += read;
      if (!kDirectional) continue;
      vec3 to = points[reads[i].lumel].position - points[lumel].position;
      vec3 factors = directionalFactors(to == vec3(0.0) ? n : normalize(to), n, kLeastReadHeight);
      x += factors.x * read, y += factors.y * read, z += factors.z * read;
    }
  }
  vec3 sloped = abs(x) + abs(y) + abs(z);
  if (any(isnan(e)) || any(isinf(e)) || any(isnan(sloped)) || any(isinf(sloped))) atomicAdd(counters[kSrpNonFinite], 1u);
  else if (any(lessThan(e, vec3(0.0)))) atomicAdd(counters[kSrpNegative], 1u);
  if (batch.clampNegative != 0u) e = max(e, vec3(0.0));
  irradiance[lumel] = vec4(e, 0.0);
  if (!kDirectional) return;
  vec3 t, b;
  orthonormalBasis(n, t, b);
  uint lumels = uint(irradiance.length());
  for (uint channel = 0u; channel < 3u; ++channel)
    slopes[channel * lumels + lumel] = vec4(x[channel] * t + y[channel] * b + z[channel] * n, 0.0);
  slopes[3u * lumels + lumel] = vec4(e - z, 0.0);  // E - slope . n0: x and y are along the surface
}
