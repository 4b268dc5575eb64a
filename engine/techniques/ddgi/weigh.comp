#version 460
#extension GL_GOOGLE_include_directive : require
// The eight probes round one point, each with the factors of its weight.
#include "engine/techniques/ddgi/lookup.glsl"

layout(local_size_x = 8) in;

layout(scalar) writeonly buffer weights_block { DdgiProbeWeight weights[]; };
layout(push_constant, scalar) uniform Constants {
  vec3 position;
  vec3 normal;
  vec3 toViewer;
} point;

void main() {
  const uint corner = gl_LocalInvocationIndex;
  DdgiProbeWeight p = weighProbe(makeAsker(point.position, point.normal, point.normal, point.toViewer), corner);
  if (p.state == kProbeActive) p.irradiance = probeIrradiance(probeIndex(p.at, grid.counts), point.normal);
  weights[corner] = p;
}
