#ifndef HALFLIGHT_DIRECT_LOBE_GLSL
#define HALFLIGHT_DIRECT_LOBE_GLSL
// The lobe of a pixel's surface, seen from batch.eye (direct_lights.glsl has the batch).
#include "shaders/shared/ggx.h"

layout(rgba32f) readonly uniform image2D specular;

struct Lobe {
  vec3 view;  ///< in the frame of the point's normal
  vec3 f0;
  float roughness;
};

Lobe lobeOf(SurfacePoint p, uint pixel) {
  const uint width = uint(imageSize(specular).x);
  const vec4 s = imageLoad(specular, ivec2(pixel % width, pixel / width));
  return Lobe(toLocal(normalize(batch.eye - p.position), p.normal), s.rgb, s.a);
}

bool isGlossy(SurfacePoint p, Lobe lobe) { return dot(p.normal, p.normal) > 0.0 && max(lobe.f0.x, max(lobe.f0.y, lobe.f0.z)) > 0.0 && lobe.view.z > 0.0; }

vec3 brdfOf(Lobe lobe, SurfacePoint p, vec3 direction) { return ggxBrdf(lobe.view, toLocal(direction, p.normal), lobe.f0, lobe.roughness); }
float pdfOf(Lobe lobe, SurfacePoint p, vec3 direction) { return ggxPdf(lobe.view, toLocal(direction, p.normal), lobe.roughness); }
#endif
