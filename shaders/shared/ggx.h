#ifndef HALFLIGHT_GGX_H
#define HALFLIGHT_GGX_H
// The lobe of glossy surfaces, the same in C++ and GLSL: Trowbridge and Reitz's (GGX) facets, Smith's height-correlated masking and shadowing, Schlick's
// Fresnel term; no light between facets, so that a rough mirror loses some. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007;
// Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014.
// Vectors are unit, point away from the surface and lie in the frame whose +z is the normal (toLocal, fromLocal); below it the lobe is 0. `roughness` is
// perceptual: alpha = roughness^2, never less than that of kMinRoughness. `f0` is the reflectance at normal incidence.
#include "shaders/shared/sampling.h"
HL_BEGIN

/// Smoother ones count as this smooth: a narrower peak no longer fits into single precision or into a sampled direction.
HL_CONST float kMinRoughness = 0.05f;

HL_INLINE float ggxAlpha(float roughness) {
  float r = max(roughness, kMinRoughness);
  return r * r;
}

/// D [1/sr] of the facets' normal `h`.
HL_INLINE float ggxDistribution(vec3 h, float alpha) {
  float a2 = alpha * alpha;
  float d = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
  return a2 / (kPi * d * d);
}

/// Directions nearer to the horizon than this cosine hide as many facets as one there: closer, nothing is left of single precision.
HL_CONST float kGrazingCosine = 1e-6f;

/// Smith's Lambda of a direction with that cosine: hidden over seen area of facets.
HL_INLINE float ggxLambda(float cosine, float alpha) {
  float c = max(cosine, kGrazingCosine);
  float c2 = c * c;
  float x = alpha * alpha * (1.0f - c2) / c2;
  return 0.5f * x / (1.0f + sqrt(1.0f + x));
}

/// G1: share of facets that is seen.
HL_INLINE float ggxMasking(float cosine, float alpha) { return 1.0f / (1.0f + ggxLambda(cosine, alpha)); }

/// G2: share that is both seen and lit, heights correlated.
HL_INLINE float ggxMaskingShadowing(float cosView, float cosLight, float alpha) {
  return 1.0f / (1.0f + ggxLambda(cosView, alpha) + ggxLambda(cosLight, alpha));
}

/// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994. `cosine`: between a direction and the facet's normal.
HL_INLINE vec3 schlickFresnel(vec3 f0, float cosine) {
  float m = clamp(1.0f - cosine, 0.0f, 1.0f);
  float m2 = m * m;
  return f0 + (vec3(1.0f) - f0) * (m2 * m2 * m);
}

/// f [1/sr], without the cosine. Reciprocal.
HL_INLINE vec3 ggxBrdf(vec3 view, vec3 light, vec3 f0, float roughness) {
  if (!(view.z > 0.0f) || !(light.z > 0.0f)) return vec3(0.0f);
  float alpha = ggxAlpha(roughness);
  vec3 h = normalize(view + light);
  float scale = ggxDistribution(h, alpha) * ggxMaskingShadowing(view.z, light.z, alpha) / (4.0f * view.z * light.z);
  return schlickFresnel(f0, dot(view, h)) * scale;
}

/// Density per solid angle of the light directions that sampleGgx gives.
HL_INLINE float ggxPdf(vec3 view, vec3 light, float roughness) {
  if (!(view.z > 0.0f) || !(light.z > 0.0f)) return 0.0f;
  float alpha = ggxAlpha(roughness);
  return ggxMasking(view.z, alpha) * ggxDistribution(normalize(view + light), alpha) / (4.0f * view.z);
}

/// Normal of a facet as often as it is seen from `view`. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
HL_INLINE vec3 sampleGgxVisibleNormal(vec3 view, float alpha, vec2 u) {
  vec3 v = normalize(vec3(alpha * view.x, alpha * view.y, view.z));
  float across2 = v.x * v.x + v.y * v.y;
  vec3 t1 = across2 > 0.0f ? vec3(-v.y, v.x, 0.0f) * inversesqrt(across2) : vec3(1.0f, 0.0f, 0.0f);
  vec3 t2 = cross(v, t1);
  float r = sqrt(u.x);
  float angle = 2.0f * kPi * u.y;
  float x = r * cos(angle);
  float s = 0.5f * (1.0f + v.z);
  float y = (1.0f - s) * sqrt(max(0.0f, 1.0f - x * x)) + s * r * sin(angle);
  vec3 n = t1 * x + t2 * y + v * sqrt(max(0.0f, 1.0f - x * x - y * y));
  return normalize(vec3(alpha * n.x, alpha * n.y, max(0.0f, n.z)));
}

struct GgxSample {
  vec3 light;   ///< the direction that light comes from
  vec3 weight;  ///< f cos / density: what radiance from there counts; 0 where the direction lies below the surface
};
HL_INLINE GgxSample sampleGgx(vec3 view, vec3 f0, float roughness, vec2 u) {
  GgxSample s;
  s.light = vec3(0.0f, 0.0f, 1.0f);
  s.weight = vec3(0.0f);
  if (!(view.z > 0.0f)) return s;
  float alpha = ggxAlpha(roughness);
  vec3 h = sampleGgxVisibleNormal(view, alpha, u);
  float c = dot(view, h);
  s.light = h * (2.0f * c) - view;
  if (!(s.light.z > 0.0f)) return s;
  float lambda = ggxLambda(view.z, alpha);
  s.weight = schlickFresnel(f0, c) * ((1.0f + lambda) / (1.0f + lambda + ggxLambda(s.light.z, alpha)));
  return s;
}

/// The directional albedo (share of light from one direction, of that cosine, that is reflected at all) of any f0 is f0 x + y. Mean of so many
/// low-discrepancy samples: 64 leave some 1e-3. For tables; not cheap.
HL_INLINE vec2 ggxScaleAndBias(float cosine, float roughness, uint samples) {
  vec3 view = vec3(sqrt(max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine);
  float black = 0.0f;
  float white = 0.0f;
  for (uint i = 0u; i < samples; ++i) {
    vec2 u = vec2((float(i) + 0.5f) / float(samples), unitFloat(reverseBits(i)));
    black += sampleGgx(view, vec3(0.0f), roughness, u).weight.x;
    white += sampleGgx(view, vec3(1.0f), roughness, u).weight.x;
  }
  return vec2(white - black, black) / float(samples);
}
HL_INLINE vec3 ggxDirectionalAlbedo(vec3 f0, float cosine, float roughness, uint samples) {
  vec2 t = ggxScaleAndBias(cosine, roughness, samples);
  return f0 * t.x + vec3(t.y);
}

HL_END
#endif
