#version 460
#extension GL_GOOGLE_include_directive : require
// The shared sampling functions at given numbers, for comparison with what C++ makes of the same source.
#include "shaders/shared/ggx.h"
layout(local_size_x = 64) in;

struct Numbers {
  vec2 u;
  uint index;
  uint seed;
  vec3 p0;
  vec3 p1;
  vec3 p2;
  vec3 normal;
};
struct Sampled {
  vec3 cosine;
  vec3 sphere;
  vec3 hemisphere;
  vec3 world;
  vec2 triangle;
  vec3 lightDirection;
  float lightDistance;
  float lightPdf;
  float solidAngle;
  float formFactor;
  float weight;
  float falloff;
  vec2 r2;
  vec2 sobol;
  vec2 shuffled;
  vec3 lobeLight;
  vec3 lobeWeight;
  vec3 lobe;
  float lobePdf;
  vec2 lobeAlbedo;
};
layout(scalar) readonly buffer numbers_block { Numbers numbers[]; };
layout(scalar) writeonly buffer sampled_block { Sampled sampled[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= uint(numbers.length())) return;
  const Numbers n = numbers[i];
  Sampled s;
  s.cosine = sampleCosineHemisphere(n.u);
  s.sphere = sampleUniformSphere(n.u);
  s.hemisphere = sampleUniformHemisphere(n.u);
  s.world = fromLocal(s.cosine, n.normal);
  s.triangle = sampleTriangle(n.u);
  const TriangleSample t = sampleTriangleLight(vec3(0.0), n.p0, n.p1, n.p2, n.u);
  s.lightDirection = t.direction;
  s.lightDistance = t.distance;
  s.lightPdf = t.pdf;
  s.solidAngle = triangleSolidAngle(vec3(0.0), n.p0, n.p1, n.p2);
  s.formFactor = triangleFormFactor(vec3(0.0), n.normal, n.p0, n.p1, n.p2);
  s.weight = powerHeuristic(n.u.x, n.u.y) - 2.0 * balanceHeuristic(n.u.x, n.u.y);
  s.falloff = spotFalloff(n.u.x, 0.9, 0.2);
  s.r2 = r2Point(n.index, uvec2(n.seed, n.seed ^ 0x5bd1e995u));
  s.sobol = sobolPoint(n.index, uvec2(n.seed, n.seed ^ 0x5bd1e995u));
  s.shuffled = shuffledSobolPoint(n.index, n.seed);
  const float roughness = float(n.index & 7u) / 7.0;
  const vec3 view = vec3(n.normal.xy, abs(n.normal.z));
  const GgxSample g = sampleGgx(view, vec3(0.04, 0.5, 1.0), roughness, n.u);
  s.lobeLight = g.light;
  s.lobeWeight = g.weight;
  s.lobe = ggxBrdf(view, toLocal(s.world, n.normal), vec3(0.04, 0.5, 1.0), roughness);
  s.lobePdf = ggxPdf(view, toLocal(s.world, n.normal), roughness);
  s.lobeAlbedo = ggxScaleAndBias(view.z, roughness, 16u);
  sampled[i] = s;
}
