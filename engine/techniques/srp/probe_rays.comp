#version 460
#extension GL_GOOGLE_include_directive : require
// Rays of probes [first, first + count): the same directions for all, each probe's in its own frame.
#include "engine/techniques/srp/probe_frame.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer probes_block { vec4 probes[]; };
layout(scalar) readonly buffer directions_block { vec4 directions[]; };
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { uint first, count, samples, seed; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count * samples) return;
  uint probe = first + i / samples;
  rays[i] = Ray(probes[probe].xyz, 0.0, rotated(directions[i % samples].xyz, probeFrame(seed, probe)), kRayEnd);
}
