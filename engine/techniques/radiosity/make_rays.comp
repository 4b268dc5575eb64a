#version 460
#extension GL_GOOGLE_include_directive : require
// A lumel's rays: the same set of directions for all, shifted (or turned) by a hash of the lumel, so that its error is noise and not a pattern.
#include "engine/techniques/radiosity/unit.h"
#include "shaders/shared/lumel_rays.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/radiosity/params.inl"
#include "shaders/shared/ray.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;  // one workgroup a lumel

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
uniform samplerBuffer directions;
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { RadiosityUnit unit; };

void main() {
  uint lumel = unit.firstLumel + gl_WorkGroupID.x;
  uint samples = uint(radiosity.samples);
  SurfacePoint p = points[lumel];
  vec3 origin = p.position + p.offset * p.geometricNormal;
  vec3 tangent, bitangent;
  orthonormalBasis(p.geometricNormal, tangent, bitangent);
  Random random = randomInit(unit.seed, lumel, 0u);
  vec2 shift = vec2(randomFloat(random), randomFloat(random));
  bool turns = radiosity.directions == kDirectionsLargestEmptyCircle;
  vec2 turn = vec2(cos(2.0 * kPi * shift.x), sin(2.0 * kPi * shift.x));
  for (uint j = gl_LocalInvocationIndex; j < samples; j += gl_WorkGroupSize.x) {
    vec2 point = texelFetch(directions, int(j)).xy;
    vec2 d = turns ? turned(point, turn) : concentricDisc(shifted(point, shift));
    vec3 direction = tangent * d.x + bitangent * d.y + p.geometricNormal * hemisphereHeight(d);
    rays[gl_WorkGroupID.x * samples + j] = Ray(origin, 0.0, direction, kRayEnd);
  }
}
