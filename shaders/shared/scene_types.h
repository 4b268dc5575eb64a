#ifndef HALFLIGHT_SCENE_TYPES_H
#define HALFLIGHT_SCENE_TYPES_H
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST uint kNoTexture = 0xffffffffu;
HL_CONST uint kMaterialTwoSided = 1u;
HL_CONST uint kMaterialEmissive = 2u;

struct GpuMaterial {
  vec3 albedo;
  float alphaCutoff;
  vec3 emission;
  uint flags;
  uint albedoTexture;  ///< layer of the texture array
  uint normalTexture;
  vec2 albedoUvScale;  ///< the part of its layer that the texture fills (layers share one size)
  vec2 normalUvScale;
};

HL_CONST uint kLightPoint = 0u;
HL_CONST uint kLightSpot = 1u;
HL_CONST uint kLightDirectional = 2u;

/// A punctual light. Directional: `intensity` is irradiance and `position` unused.
struct GpuLight {
  vec3 position;
  uint type;
  vec3 direction;
  float cosInner;
  vec3 intensity;
  float cosOuter;
};

/// An emissive triangle with the probability of choosing it (proportional to area times luminance) and the running sum before it.
struct GpuEmitter {
  vec3 p0;
  float probability;
  vec3 p1;
  float cumulative;
  vec3 p2;
  uint triangle;
  vec3 emission;
  float area;
};

HL_END
#endif
