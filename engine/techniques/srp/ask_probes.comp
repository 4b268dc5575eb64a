#version 460
#extension GL_GOOGLE_include_directive : require
// Mutual visibility (section 5.6.4): rays from what a receiver sees to each probe that it asks, and the probe's share where nothing is between. Those that need
// no cast are inactive (tMin > tMax) and have no share: probes behind the surface, empty slots, backs of surfaces. A negative share: of a probe that would blur too much.
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer near_block { SrpNear near[]; };
layout(scalar) readonly buffer probes_block { vec4 probes[]; };
uniform samplerBuffer triangles;
layout(scalar) writeonly buffer questions_block { Ray questions[]; };
layout(scalar) writeonly buffer shares_block { float shares[]; };
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= unit.receivers * unit.samples * unit.slots) return;
  uint r = i / unit.slots;
  SrpNear n = near[(r / unit.samples) * unit.slots + i % unit.slots];
  Ray question = Ray(vec3(0.0), 1.0, vec3(0.0, 0.0, 1.0), 0.0);
  float share = 0.0;
  if (n.weight > 0.0) {
    Ray ray = rays[r];
    Hit hit = hits[r];
    vec3 probe = probes[n.probe].xyz;
    if (hit.primitive == kMiss) {
      if (unit.environment != 0u && unit.surfaceShare == 0u) {
        question = Ray(probe, 0.0, ray.direction, kRayEnd);
        share = n.weight;
      }
    } else {
      vec3 normal = tableNormal(texelFetch(triangles, int(2u * hit.primitive + 1u)));
      vec3 at = ray.origin + hit.t * ray.direction + unit.offset * normal;
      vec3 way = probe - at;
      float height = dot(normal, way);
      if (dot(normal, ray.direction) < 0.0 && height > 0.0) {
        question = Ray(at, 0.0, way, 1.0);
        float d = length(way);
        float d3 = d * d * d;
        share = unit.solidAngle != 0u ? n.weight * height / d3 : n.weight;
        // The solid angle that the probe tells apart covers d^2 resolution^2 / cos of the surface.
        float resolution = kPi / float(unit.order + 1);
        float wide = unit.blurLimit * hit.t;
        // Not where reflections are asked for too: a lumel so near says what comes from there, and not well enough from which direction.
        bool limited = unit.blurLimit > 0.0 && r / unit.samples >= unit.wide;
        if (limited && d3 * resolution * resolution > height * wide * wide) share = -share;
      }
    }
  }
  questions[i] = question;
  shares[i] = share;
}
