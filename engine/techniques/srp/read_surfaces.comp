#version 460
#extension GL_GOOGLE_include_directive : require
// Which lumels a receiver reads for those of a unit's samples that no probe sees, or none well enough: in each stratum of its samples one of them, chosen evenly as they come by, whatever
// units they come in. Where the ray goes into the open nothing is reflected: valid, and dark.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
uniform samplerBuffer triangles;
layout(scalar) readonly buffer lumelOfTexel_block { uint lumelOfTexel[]; };
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) buffer strata_block { SrpStratum strata[]; };  // reads a receiver
layout(scalar) buffer answered_block { float answered[]; };   // samples a receiver that no probe sees and that are known all the same
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint receiver = gl_GlobalInvocationID.x;
  if (receiver >= unit.receivers) return;
  uint lumel = points[unit.firstReceiver + receiver].flags;
  float known = 0.0;
  for (uint s = 0u; s < unit.samples; ++s) {
    uint r = receiver * unit.samples + s;
    float kind = scales[r];
    if (kind != kSrpInvalid && kind != kSrpCoarse) continue;
    Hit hit = hits[r];
    if (hit.primitive == kMiss) {
      if (unit.environment != 0u) known += 1.0;
      continue;
    }
    vec4 first = texelFetch(triangles, int(2u * hit.primitive));
    vec4 second = texelFetch(triangles, int(2u * hit.primitive + 1u));
    uint code = codeOfLumel(lumelOfTexel[texelHit(first, second, hit.u, hit.v, unit.resolution)]);
    if (code == kCodeNoTexel) {
      if (kind == kSrpCoarse) known -= 1.0;  // counted with those that are answered (accumulate.comp): it is not
      continue;
    }
    if (kind == kSrpInvalid) known += 1.0;
    uint sampleIndex = unit.firstSample + s;
    uint stratum = receiver * unit.reads + sampleIndex * unit.reads / unit.allSamples;
    uint count = strata[stratum].count + 1u;
    Random random = randomInit(unit.seed, lumel, sampleIndex + 1u);
    if (randomFloat(random) * float(count) < 1.0) strata[stratum].lumel = code;
    strata[stratum].count = count;
  }
  answered[receiver] += known;
}
