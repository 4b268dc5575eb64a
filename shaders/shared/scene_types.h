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
  vec3 specular;       ///< reflectance at normal incidence; 0: the surface is diffuse
  float roughness;     ///< perceptual, of the lobe in ggx.h
};

/// Where an object is. Its rest pose is the geometry as the scene's file has it; what moves keeps its triangles, and vertices are those of the rest pose
/// through `restToWorld` (normals through the inverse transpose). Points that should move with an object are kept in its rest pose.
struct ObjectTransform {
  mat4 restToWorld;          ///< in this frame
  mat4 previousRestToWorld;  ///< in the frame before
  mat4 worldToRest;          ///< inverse of restToWorld
  uint moved;                ///< 1 where the two frames differ
  uint movable;              ///< 1 where an animation moves it at some time; else all three are identities for good
};

/// A vertex that moves, in its object's rest pose.
struct MovingVertex {
  vec3 position;
  uint vertex;
  vec3 normal;
  uint object;
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
