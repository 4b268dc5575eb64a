#version 460
#extension GL_GOOGLE_include_directive : require
// E = pi * sum of weight times radiance of what was hit. The order of the sum is fixed, so that the result is the same to the bit however it came.
#include "engine/techniques/radiosity/unit.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/radiosity/params.inl"
#include "shaders/shared/sampling.h"

layout(local_size_x = 64) in;  // kGatherLanes * kGatherLumels

layout(scalar) readonly buffer codes_block { uint codes[]; };
uniform samplerBuffer directions;
uniform samplerBuffer radiance;  // that lumels send out, each the same in all directions
layout(scalar) buffer irradiance_block { vec4 irradiance[]; };  // w: change of luminance against the last bounce
layout(scalar) buffer counters_block { uint counters[]; };
layout(push_constant, scalar) uniform Constants { RadiosityUnit unit; };

shared vec3 parts[kGatherLanes * kGatherLumels];

float luminanceOf(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

void count(uint which, uint n) {
  if (n != 0u && atomicAdd(counters[2u * which], n) > 0xffffffffu - n) atomicAdd(counters[2u * which + 1u], 1u);
}

void main() {
  uint thread = gl_LocalInvocationIndex;
  uint lane = thread % kGatherLanes;
  uint index = gl_WorkGroupID.x * kGatherLumels + thread / kGatherLanes;
  uint samples = uint(radiosity.samples);
  vec3 sum = vec3(0.0);
  uint backFaces = 0u, withoutTexel = 0u;
  if (index < unit.lumels) {
    uint base = unit.codeBase + index * samples;
    for (uint j = lane; j < samples; j += kGatherLanes) {
      uint code = codes[base + j];
      if (code < kFirstCode) sum += texelFetch(directions, int(j)).z * texelFetch(radiance, int(code)).xyz;
      if (code == kCodeBackFace) ++backFaces;
      if (code == kCodeNoTexel) ++withoutTexel;
    }
  }
  if (unit.counting != 0u) {
    count(kCountBackFace, backFaces);
    count(kCountNoTexel, withoutTexel);
  }
  parts[thread] = sum;
  barrier();
  if (lane != 0u || index >= unit.lumels) return;
  for (uint k = 1u; k < kGatherLanes; ++k) sum += parts[thread + k];
  vec3 e = kPi * sum;
  uint lumel = unit.firstLumel + index;
  vec3 before = irradiance[lumel].xyz;
  irradiance[lumel] = vec4(e, luminanceOf(abs(e - before)));
  if (any(isnan(e)) || any(isinf(e))) count(kCountNonFinite, 1u);
}
