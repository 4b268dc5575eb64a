#version 460
#extension GL_GOOGLE_include_directive : require
// A lumel's rays: the same set of directions for all, shifted (or turned) by a hash of the lumel, so that its error is noise and not a pattern.
#include "engine/techniques/radiosity/unit.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/radiosity/params.inl"
#include "shaders/shared/ray.h"
#include "shaders/shared/sampling.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;  // one workgroup a lumel

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
uniform samplerBuffer directions;
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { RadiosityUnit unit; };

/// sampleDisc without its range reduction: the angle stays within an eighth of a turn, where these polynomials are good to 4e-8. Rays are
/// made as fast as they are traced only because of this.
vec2 disc(vec2 u) {
  vec2 p = 2.0 * u - 1.0;
  bool wide = abs(p.x) > abs(p.y);
  float r = wide ? p.x : p.y;
  float a = r == 0.0 ? 0.0 : 0.25 * kPi * (wide ? p.y : p.x) / r;
  float a2 = a * a;
  float s = a * (1.0 + a2 * (-1.6666655e-1 + a2 * (8.3321609e-3 + a2 * -1.9515296e-4)));
  float c = 1.0 + a2 * (-0.5 + a2 * (4.1666642e-2 + a2 * (-1.3887316e-3 + a2 * 2.4433157e-5)));
  return r * (wide ? vec2(c, s) : vec2(s, c));
}

void main() {
  uint lumel = unit.firstLumel + gl_WorkGroupID.x;
  uint samples = uint(radiosity.samples);
  SurfacePoint p = points[lumel];
  vec3 origin = p.position + p.offset * p.geometricNormal;
  vec3 tangent, bitangent;
  orthonormalBasis(p.geometricNormal, tangent, bitangent);
  Random random = randomInit(unit.seed, lumel, 0u);
  vec2 shift = vec2(randomFloat(random), randomFloat(random));
  bool turned = radiosity.directions == kDirectionsLargestEmptyCircle;
  vec2 turn = vec2(cos(2.0 * kPi * shift.x), sin(2.0 * kPi * shift.x));
  for (uint j = gl_LocalInvocationIndex; j < samples; j += gl_WorkGroupSize.x) {
    vec2 point = texelFetch(directions, int(j)).xy;
    vec2 d = turned ? vec2(turn.x * point.x - turn.y * point.y, turn.y * point.x + turn.x * point.y) : disc(fract(point + shift));
    // Their range, tMin and tMax, is the same for all and was written once.
    uint r = gl_WorkGroupID.x * samples + j;
    rays[r].origin = origin;
    rays[r].direction = tangent * d.x + bitangent * d.y + p.geometricNormal * sqrt(max(0.0, 1.0 - dot(d, d)));
  }
}
