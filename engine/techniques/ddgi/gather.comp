#version 460
#extension GL_GOOGLE_include_directive : require
// Irradiance at pixels. The back of a one-sided material receives nothing.
#define HL_SCENE_MATERIALS
#include "shaders/scene.glsl"
#include "engine/techniques/ddgi/lookup.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D normal;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rg32ui) readonly uniform uimage2D ids;
layout(rgba32f) writeonly uniform image2D result;
layout(scalar) buffer counters_block { uint counters[]; };
layout(push_constant, scalar) uniform Constants { vec3 viewer; };

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  const vec4 place = imageLoad(position, pixel);
  vec4 e = vec4(0.0);
  if (place.w > 0.0 || (place.w < 0.0 && isTwoSided(materials[imageLoad(ids, pixel).y]))) {
    e = cachedIrradiance(place.xyz, imageLoad(normal, pixel).xyz, imageLoad(geometricNormal, pixel).xyz, normalize(viewer - place.xyz));
    if (e.w == 0.0) atomicAdd(counters[kCountPixelsWithoutProbe], 1u);
  }
  imageStore(result, pixel, vec4(e.xyz, 1.0));
}
