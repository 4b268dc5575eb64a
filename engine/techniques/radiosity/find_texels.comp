#version 460
#extension GL_GOOGLE_include_directive : require
// From hits to the lumels that were hit. A pass of its own, so that a cached ray goes the very same way as a new one.
#include "engine/techniques/radiosity/unit.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/radiosity/params.inl"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

uniform samplerBuffer rays;  // of which only directions are read: a quarter of what a storage buffer's scattered loads cost on a CPU
layout(scalar) readonly buffer hits_block { Hit hits[]; };
uniform samplerBuffer triangles;  // two texels each: uv of corner 0, edge to 1; edge to 2, normal (octahedral)
layout(scalar) readonly buffer lumelOfTexel_block { uint lumelOfTexel[]; };
layout(scalar) writeonly buffer codes_block { uint codes[]; };
layout(push_constant, scalar) uniform Constants { RadiosityUnit unit; };

vec3 decodeNormal(vec2 e) {
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return n;
}

void main() {
  uint r = gl_GlobalInvocationID.x;
  if (r >= unit.lumels * uint(radiosity.samples)) return;
  Hit hit = hits[r];
  uint code = kCodeMiss;
  if (hit.primitive != kMiss) {
    vec4 a = texelFetch(triangles, int(2u * hit.primitive));
    vec4 b = texelFetch(triangles, int(2u * hit.primitive + 1u));
    if (dot(decodeNormal(b.zw), texelFetch(rays, int(2u * r + 1u)).xyz) >= 0.0) {
      code = kCodeBackFace;
    } else {
      vec2 uv = a.xy + hit.u * a.zw + hit.v * b.xy;
      ivec2 texel = clamp(ivec2(floor(uv * float(unit.resolution))), ivec2(0), ivec2(int(unit.resolution) - 1));
      uint lumel = lumelOfTexel[uint(texel.y) * unit.resolution + uint(texel.x)];
      code = lumel == kNoLumel ? kCodeNoTexel : lumel & ~kBorrowed;
    }
  }
  codes[unit.codeBase + r] = code;
}
