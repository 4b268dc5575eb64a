#version 460
#extension GL_GOOGLE_include_directive : require
// The G-buffer's pixels as points that receive light.
#include "shaders/shared/surface_point.h"

layout(local_size_x = 64) in;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D normal;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rg32ui) readonly uniform uimage2D ids;
layout(scalar) writeonly buffer points_block { SurfacePoint points[]; };
layout(push_constant, scalar) uniform Constants {
  uint firstPixel;
  uint count;
  float offset;
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  int width = imageSize(position).x;
  int index = int(firstPixel + i);
  ivec2 pixel = ivec2(index % width, index / width);
  vec4 place = imageLoad(position, pixel);
  SurfacePoint p = SurfacePoint(place.xyz, offset, vec3(0.0), 0u, vec3(0.0), 0u);
  if (place.w != 0.0) {
    p.normal = imageLoad(normal, pixel).xyz;
    p.geometricNormal = imageLoad(geometricNormal, pixel).xyz;
    p.triangle = imageLoad(ids, pixel).x - 1u;
  }
  points[i] = p;
}
