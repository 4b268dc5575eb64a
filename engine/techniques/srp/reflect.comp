#version 460
#extension GL_GOOGLE_include_directive : require
// What glossy surfaces reflect towards the camera: the lobe's integral with each function of the hemisphere's basis, over a fixed spiral of facets as the eye sees them, and those with the
// coefficients of the texels round the pixel. Texels of other charts, and those of surfaces that are not glossy, are left out as in lightmap_apply.comp.
#include "engine/techniques/srp/hemisphere_basis.h"
#include "engine/techniques/srp/unit.h"
#include "shaders/shared/ggx.h"
#include "shaders/shared/lightmap_codes.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int kDegree = 4;
const int kTerms = (kDegree + 1) * (kDegree + 2) / 2;

/// Turns from one sample of the spiral to the next: of lattices over the disc of visible facets the evenest (README).
const float kGoldenTurn = 0.61803398875;

/// Texels whose normals agree to this cosine have one frame, to rounding.
const float kSameNormal = 0.999999;

layout(rgba32f) readonly uniform image2D position;
layout(rgba32f) readonly uniform image2D normal;
layout(rgba32f) readonly uniform image2D geometricNormal;
layout(rgba32f) readonly uniform image2D specular;
layout(rg32ui) readonly uniform uimage2D ids;
layout(scalar) readonly buffer chartOfTriangle_block { uint chartOfTriangle[]; };
layout(scalar) readonly buffer chartOfTexel_block { uint chartOfTexel[]; };
layout(scalar) readonly buffer glossyOfTexel_block { uint glossyOfTexel[]; };  // receiver among those on glossy surfaces, or kNoLumel
layout(scalar) readonly buffer normals_block { vec3 normals[]; };              // of those
layout(scalar) readonly buffer incident_block { vec3 incident[]; };            // ... x coefficients
layout(rgba32f) writeonly uniform image2D result;
layout(scalar) buffer counters_block { uint counters[]; };
layout(push_constant, scalar) uniform Constants { SrpReflect reflection; };

/// Integrals of lobe x cosine x function: reflectance at normal incidence times the first plus the second.
float scales[kTerms];
float biases[kTerms];

void integrate(vec3 frameNormal, vec3 pixelNormal, vec3 view, float roughness) {
  vec3 t, b;
  orthonormalBasis(frameNormal, t, b);
  for (int j = 0; j < kTerms; ++j) scales[j] = 0.0, biases[j] = 0.0;
  vec3 localView = toLocal(view, pixelNormal);
  for (uint i = 0u; i < reflection.samples; ++i) {
    float at = float(i) + 0.5;
    vec2 u = vec2(at / float(reflection.samples), fract(at * kGoldenTurn));
    GgxSample s = sampleGgx(localView, vec3(0.0, 1.0, 0.0), roughness, u);
    if (!(s.weight.y > 0.0)) continue;
    vec3 w = fromLocal(s.light, pixelNormal);
    float x = dot(w, t), y = dot(w, b), bias = s.weight.x, scale = s.weight.y - s.weight.x;
    HemisphereColumn c = hemisphereBegin(x, y);
    for (int m = 0;; ++m) {
      for (int degree = m;; degree += 2) {
        float value = c.current * c.cosine;
        int j = hemisphereIndex(degree, m);
        scales[j] += scale * value, biases[j] += bias * value;
        if (m > 0) {
          value = c.current * c.sine;
          j = hemisphereIndex(degree, -m);
          scales[j] += scale * value, biases[j] += bias * value;
        }
        if (degree + 2 > kDegree) break;
        hemisphereNextDegree(c);
      }
      if (m == kDegree) break;
      hemisphereNextColumn(c, x, y);
    }
  }
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(result)))) return;
  vec4 at = imageLoad(position, pixel), lobe = imageLoad(specular, pixel);
  vec3 value = vec3(0.0);
  if (at.w > 0.0 && any(greaterThan(lobe.xyz, vec3(0.0)))) {
    vec4 geometric = imageLoad(geometricNormal, pixel);
    vec3 view = normalize(reflection.eye - at.xyz);
    uint chart = chartOfTriangle[imageLoad(ids, pixel).x - 1u];
    int side = int(sqrt(float(chartOfTexel.length())) + 0.5);
    vec2 p = vec2(imageLoad(normal, pixel).w, geometric.w) * float(side);
    ivec2 low = ivec2(floor(p - 0.5));
    vec2 f = p - 0.5 - vec2(low);
    vec3 frameNormal = vec3(0.0), frameTangent = vec3(0.0);
    float weights = 0.0;
    for (int corner = 0; corner < 4; ++corner) {
      ivec2 step = ivec2(corner & 1, corner >> 1), texel = low + step;
      float weight = (step.x == 1 ? f.x : 1.0 - f.x) * (step.y == 1 ? f.y : 1.0 - f.y);
      if (weight <= 0.0 || any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(side)))) continue;
      uint t = uint(texel.y * side + texel.x);
      if (chartOfTexel[t] != chart) continue;
      uint receiver = glossyOfTexel[t];
      if (receiver == kNoLumel) continue;
      // On curved charts each texel has a frame of its own.
      vec3 tangent, bitangent;
      orthonormalBasis(normals[receiver], tangent, bitangent);
      // Two normals that are alike may have frames that are not: they turn round where z changes its sign.
      if (dot(normals[receiver], frameNormal) < kSameNormal || dot(tangent, frameTangent) < kSameNormal) {
        frameNormal = normals[receiver], frameTangent = tangent;
        integrate(frameNormal, geometric.xyz, view, lobe.w);
      }
      vec3 sum = vec3(0.0);
      for (int j = 0; j < kTerms; ++j) sum += incident[receiver * uint(kTerms) + uint(j)] * (lobe.xyz * scales[j] + biases[j]);
      value += weight * sum;
      weights += weight;
    }
    if (weights > 0.0) value /= weights * float(reflection.samples);
    else atomicAdd(counters[kSrpReflectedNoTexel], 1u);
    if (any(isnan(value)) || any(isinf(value))) atomicAdd(counters[kSrpReflectedNonFinite], 1u);
    else if (any(lessThan(value, vec3(0.0)))) atomicAdd(counters[kSrpReflectedNegative], 1u);
    if (reflection.clampNegative != 0u) value = max(value, vec3(0.0));
  }
  imageStore(result, pixel, vec4(value, 1.0));
}
