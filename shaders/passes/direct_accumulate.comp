#version 460
#extension GL_GOOGLE_include_directive : require
// Adds what arrived at each point to its sum; w counts samples.
#include "shaders/passes/direct_batch.h"

layout(local_size_x = 64) in;

layout(scalar) readonly buffer unshadowed_block { vec3 unshadowed[]; };
layout(scalar) readonly buffer occluded_block { uint occluded[]; };
layout(scalar) buffer irradiance_block { vec4 irradiance[]; };
layout(push_constant, scalar) uniform Constants { DirectBatch batch; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= batch.count) return;
  vec3 punctual = vec3(0.0), sampled = vec3(0.0);
  uint slots = directSlots(batch);
  for (uint slot = 0u; slot < slots; ++slot) {
    uint ray = slot * batch.count + i;
    vec3 arrived = occluded[ray] != 0u ? vec3(0.0) : unshadowed[ray];
    if (slot < batch.lights) punctual += arrived;
    else sampled += arrived;
  }
  irradiance[batch.targetBase + i] += vec4(punctual * float(batch.samples) + sampled, float(batch.samples));
}
