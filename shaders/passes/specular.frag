#version 460
#extension GL_GOOGLE_include_directive : require
// The lobe of the surface that each pixel sees: constants of its material.
#include "shaders/shared/scene_types.h"

layout(scalar) readonly buffer materials_block { GpuMaterial materials[]; };
uniform sampler2D position;
uniform usampler2D ids;

layout(location = 0) out vec4 outSpecular;

void main() {
  const ivec2 p = ivec2(gl_FragCoord.xy);
  outSpecular = vec4(0.0);
  const float side = texelFetch(position, p, 0).w;
  if (side == 0.0) return;
  const GpuMaterial material = materials[texelFetch(ids, p, 0).y];
  if (side > 0.0 || (material.flags & kMaterialTwoSided) != 0u) outSpecular = vec4(material.specular, material.roughness);
}
