#version 460
#extension GL_GOOGLE_include_directive : require
// From where to where the pixels of each tile lie, along the camera's axis: surfels before or behind them light none of them.
#include "engine/techniques/surfels/cache.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) readonly uniform image2D position;
layout(scalar) writeonly buffer tile_depths { vec2 tileDepths[]; };

shared uint nearest, farthest;

const float kRounding = 1e-5;  ///< of the distance: what the two sides' rounding may differ by

void main() {
  const uint i = gl_LocalInvocationIndex;
  if (i == 0u) nearest = 0x7f7fffffu, farthest = 0u;
  barrier();
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const vec4 place = all(lessThan(pixel, imageSize(position))) ? imageLoad(position, pixel) : vec4(0.0);
  if (place.w != 0.0) {
    const uint depth = floatBitsToUint(max(0.0, dot(place.xyz - frame.eye, frame.forward)));  // of one sign: ordered as numbers are
    atomicMin(nearest, depth);
    atomicMax(farthest, depth);
  }
  barrier();
  const uint across = (frame.width + kSplatPixels - 1u) / kSplatPixels;
  if (i == 0u) tileDepths[gl_WorkGroupID.y * across + gl_WorkGroupID.x] = vec2(uintBitsToFloat(nearest) * (1.0 - kRounding), uintBitsToFloat(farthest) * (1.0 + kRounding));
}
