#pragma once
// A scene's buffers and textures on the device, as shaders read them (shaders/scene.glsl has the matching declarations).
#include "engine/gpu/resources.h"
#include "engine/scene/scene.h"
#include "shaders/shared/environment.h"
#include "shaders/shared/scene_types.h"

namespace hl {

class Device;

struct GpuScene {
  Buffer positions;      ///< vec3 a vertex
  Buffer normals;        ///< vec3 a vertex
  Buffer uvs;            ///< vec2 a vertex
  Buffer indices;        ///< uvec3 a triangle
  Buffer materialIds;    ///< uint a triangle
  Buffer objectIds;      ///< uint a triangle
  Buffer objectTransforms;  ///< shared::ObjectTransform an object, of this frame and of the one before; identities where nothing moves
  Buffer movingVertices;    ///< shared::MovingVertex: the rest pose of those vertices that move; empty where none does
  Buffer materials;      ///< GpuMaterial
  Buffer lights;         ///< GpuLight; at least one element is allocated, lightCount says how many count
  Buffer emitters;       ///< GpuEmitter
  Texture2dArray textures;  ///< RGBA8, every layer of one size, white where there is nothing; read through shaders/scene.glsl alone, which
                            ///< repeats, filters and undoes the sRGB curve as engine/scene/texture_sampling.h does on the host
  uint64_t textureBytes = 0;
  uint32_t triangleCount = 0, lightCount = 0, emitterCount = 0, objectCount = 0, movingVertexCount = 0;
  float emitterPower = 0;   ///< sum of area times luminance, the normaliser of GpuEmitter::probability
  vec3 sky{0.0f};
  Buffer environmentTexels;  ///< vec3, rows from the top; one element at least
  Buffer environmentTable;   ///< EnvironmentLight::table()
  shared::EnvironmentInfo environment{};
  float diagonal = 0;       ///< of the scene's bounds [m]; ray offsets are shares of it
  SceneFeatures features;
  std::vector<std::pair<std::string, uint64_t>> memory() const;  ///< bytes by resource
};

/// Positions and normals are world space, as the scene has them; where objects move, recordPose() (engine/passes/pose.h) writes those of a frame.
GpuScene uploadScene(Device&, const Scene&);
/// One a object. Blocking, in the place of the transforms of before.
void updateTransforms(Device&, GpuScene&, std::span<const shared::ObjectTransform>);
/// Emissive triangles moved with their objects: their corners and areas, nothing else.
void updateEmitters(Device&, GpuScene&, const Scene&);
/// Lights, sky and emission changed, geometry not.
void updateLights(Device&, GpuScene&, const Scene&);

}  // namespace hl
