// A batch of rays as a launch of the ray generation shader: one ray an invocation, in rows where one row would be too long.
#extension GL_EXT_ray_tracing : require
#include "shaders/shared/ray.h"

uniform accelerationStructureEXT sceneStructure;
layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(push_constant, scalar) uniform Constants { uint rayCount; };

uint rayIndex() { return gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x; }

/// What the pipeline may be given: an interval that is not empty and starts at 0 or later (a NaN in it makes it empty), and a direction.
bool traceable(inout Ray ray) {
  bool interval = ray.tMin <= ray.tMax;
  ray.tMin = max(ray.tMin, 0.0);
  ray.tMax = min(ray.tMax, 3.4e38);
  vec3 d = abs(ray.direction);
  float most = max(d.x, max(d.y, d.z));
  return interval && ray.tMin <= ray.tMax && most > 0.0 && most <= 3.4e38 && !any(isnan(ray.direction)) && !any(isnan(ray.origin)) && !any(isinf(ray.origin));
}
