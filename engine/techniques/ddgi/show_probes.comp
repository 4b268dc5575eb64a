#version 460
#extension GL_GOOGLE_include_directive : require
// Probes as balls in the scene: what they know of the light, or the state they are in. Each lies within half a spacing of its lattice point, so a
// walk from cell to cell along the pixel's ray meets every ball that the ray does.
#include "engine/techniques/ddgi/lookup.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const bool kStates = false;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rgba32f) readonly uniform image2D background;
layout(rgba32f) writeonly uniform image2D result;
layout(push_constant, scalar) uniform Constants {
  vec3 origin;
  vec3 forward;
  vec3 right;
  vec3 down;
} camera;

const float kRadius = 0.08;     // spacings
const float kDimmed = 0.35;

struct Seen {
  float t;
  uint probe;
};

Seen firstBall(vec3 origin, vec3 direction, float end) {
  Seen seen = Seen(end, 0xffffffffu);
  const vec3 low = grid.first - 0.5 * grid.spacing, high = low + grid.spacing * vec3(grid.counts);
  const vec3 safe = mix(direction, vec3(1e-12), lessThan(abs(direction), vec3(1e-12)));
  const vec3 a = (low - origin) / safe, b = (high - origin) / safe;
  const vec3 nearSides = min(a, b), farSides = max(a, b);
  const float enter = max(0.0, max(nearSides.x, max(nearSides.y, nearSides.z)));
  const float leave = min(end, min(farSides.x, min(farSides.y, farSides.z)));
  if (enter >= leave) return seen;
  const vec3 start = (origin + safe * enter - low) / grid.spacing;
  ivec3 cell = clamp(ivec3(floor(start)), ivec3(0), ivec3(grid.counts) - 1);
  const ivec3 step = ivec3(sign(safe));
  const vec3 delta = abs(grid.spacing / safe);
  vec3 next = (low + (vec3(cell) + max(vec3(step), vec3(0.0))) * grid.spacing - origin) / safe;
  const float radius = kRadius * grid.leastSpacing;
  while (all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, ivec3(grid.counts)))) {
    const uint probe = probeIndex(uvec3(cell), grid.counts);
    const vec3 to = texelFetch(probes, int(probe)).xyz - origin;
    const float along = dot(to, direction), across = dot(to, to) - along * along;
    if (across < radius * radius) {
      const float t = along - sqrt(radius * radius - across);
      if (t > 0.0 && t < seen.t) seen = Seen(t, probe);
    }
    const float reached = min(next.x, min(next.y, next.z));
    if (seen.probe != 0xffffffffu || reached > leave) break;
    if (next.x == reached) cell.x += step.x, next.x += delta.x;
    else if (next.y == reached) cell.y += step.y, next.y += delta.y;
    else cell.z += step.z, next.z += delta.z;
  }
  return seen;
}

vec3 stateColour(vec4 probe, uint index) {
  if (probe.w == float(kProbeInside)) return vec3(0.9, 0.15, 0.1);
  if (probe.w == float(kProbeUnneeded)) return vec3(0.25);
  const vec3 home = grid.first + grid.spacing * vec3(probeAt(index, grid.counts));
  return length(probe.xyz - home) > 0.001 * grid.leastSpacing ? vec3(0.1, 0.55, 0.95) : vec3(0.2, 0.8, 0.25);
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(result);
  if (any(greaterThanEqual(pixel, size))) return;
  const vec2 at = (vec2(pixel) + 0.5) / vec2(size) * 2.0 - 1.0;
  const vec3 direction = normalize(camera.forward + at.x * camera.right + at.y * camera.down);
  const vec4 place = imageLoad(position, pixel);
  const Seen seen = firstBall(camera.origin, direction, place.w != 0.0 ? length(place.xyz - camera.origin) : 1e30);
  vec3 colour = kDimmed * imageLoad(background, pixel).xyz;
  if (kStates) colour = place.w == 0.0 ? vec3(0.0) : vec3(0.1 + 0.4 * abs(dot(imageLoad(geometricNormal, pixel).xyz, direction)));
  if (seen.probe != 0xffffffffu) {
    const vec4 probe = texelFetch(probes, int(seen.probe));
    const vec3 normal = normalize(camera.origin + direction * seen.t - probe.xyz);
    const float facing = max(0.0, -dot(normal, direction));
    if (kStates) colour = stateColour(probe, seen.probe) * (0.4 + 0.6 * facing);
    else if (probe.w == float(kProbeActive)) colour = probeIrradiance(seen.probe, normal);
    else colour = vec3(0.0);
  }
  imageStore(result, pixel, vec4(colour, 1.0));
}
