#version 460
#extension GL_GOOGLE_include_directive : require
// A lumel's rays: the same set of directions for all, shifted (or turned) by a hash of the lumel, so that its error is noise and not a pattern.
#include "engine/techniques/radiosity/unit.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/radiosity/params.inl"
#include "shaders/shared/ray.h"
#include "shaders/shared/sampling.h"
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer points_block { SurfacePoint points[]; };
layout(scalar) readonly buffer directions_block { vec4 directions[]; };
layout(scalar) writeonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { RadiosityUnit unit; };

void main() {
  uint r = gl_GlobalInvocationID.x;
  uint samples = uint(radiosity.samples);
  if (r >= unit.lumels * samples) return;
  uint lumel = unit.firstLumel + r / samples;
  SurfacePoint p = points[lumel];
  vec2 point = directions[r % samples].xy;
  Random random = randomInit(unit.seed, lumel, 0u);
  vec2 shift = vec2(randomFloat(random), randomFloat(random));
  vec2 d;
  if (radiosity.directions == kDirectionsLargestEmptyCircle) {
    float angle = 2.0 * kPi * shift.x;
    d = vec2(cos(angle) * point.x - sin(angle) * point.y, sin(angle) * point.x + cos(angle) * point.y);
  } else {
    d = sampleDisc(fract(point + shift));
  }
  Ray ray;
  ray.origin = p.position + p.offset * p.geometricNormal;
  ray.tMin = 0.0;
  ray.direction = fromLocal(vec3(d, sqrt(max(0.0, 1.0 - dot(d, d)))), p.geometricNormal);
  ray.tMax = 1e30;
  rays[r] = ray;
}
