#pragma once
// A scene as plain data, in metres, +Y up, right-handed, linear Rec. 709. Everything else (GPU buffers, Embree's scene, the lightmap
// atlas) is derived from it. Geometry is one indexed triangle list in world space: triangle t is indices[t], its material materials[t].
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace hl {

inline constexpr uint32_t kNone = 0xffffffffu;

/// 8-bit RGBA as stored in the file, top row first; an albedo texture is sRGB, a normal map linear.
struct Texture {
  std::string name;
  int width = 0, height = 0;
  bool srgb = true;
  std::vector<uint8_t> rgba;
};

inline constexpr float kDefaultRoughness = 0.5f;

struct Material {
  std::string name;
  vec3 albedo{0.8f};      ///< multiplied by the texture; the product is capped at kMaxAlbedo (counted at import)
  vec3 emission{0.0f};    ///< radiance [W/(sr m^2)] of the front side; emitters are one-sided
  uint32_t albedoTexture = kNone, normalTexture = kNone;
  float alphaCutoff = 0;  ///< > 0: where the albedo texture's alpha is below it there is no surface
  bool twoSided = false;  ///< false: the back reflects nothing (and is counted when seen or hit)
  vec3 specular{0.0f};    ///< reflectance at normal incidence, [0, 1]; above 0 the surface is glossy, with the lobe of shaders/shared/ggx.h on top of the diffuse one.
                          ///< Capped to what the albedo leaves of 1 (counted at import); has no texture
  float roughness = kDefaultRoughness;  ///< perceptual, [shared::kMinRoughness, 1]; alpha is its square. Means nothing without `specular`
  bool glossy() const { return specular.x > 0 || specular.y > 0 || specular.z > 0; }
};
inline constexpr float kMaxAlbedo = 0.99f;

struct PointLight {
  std::string name;
  vec3 position{0.0f};
  vec3 intensity{1.0f};  ///< W/sr
};
struct SpotLight {
  std::string name;
  vec3 position{0.0f}, direction{0, -1, 0};  ///< unit, away from the light
  vec3 intensity{1.0f};                      ///< W/sr on the axis
  float innerAngle = 0.3f, outerAngle = 0.5f;  ///< half-angles [rad]; smoothstep of the angle's cosine between them
};
struct DirectionalLight {
  std::string name;
  vec3 direction{0, -1, 0};  ///< unit, the way the light travels
  vec3 irradiance{1.0f};     ///< W/m^2 on a surface that faces it
};

/// Radiance from every direction that hits nothing, by an equirectangular map (shaders/shared/environment.h says which way it lies); the constant sky comes on top.
struct Environment {
  std::string file;             ///< that it came from
  int width = 0, height = 0;
  std::vector<vec3> radiance;   ///< rows from the top (+Y)
  float rotation = 0;           ///< [rad], clockwise seen from above
  vec3 scale{1.0f};             ///< of the radiance
  bool empty() const { return radiance.empty(); }
};

struct Camera {
  std::string name;
  vec3 position{0, 1, 5}, target{0, 1, 0}, up{0, 1, 0};
  float verticalFov = 0.8f;  ///< [rad]
  /// Whether both look the same way from the same place, whatever they are called.
  bool seesAs(const Camera& o) const { return position == o.position && target == o.target && up == o.up && verticalFov == o.verticalFov; }
};

/// What an animation does after its last key.
enum class Repeat { Once, Loop, PingPong };

/// Where an object is at a moment: p -> pivot + translation + R (scale (p - pivot)), R about the animation's axis.
struct PoseKey {
  float time = 0;          ///< [s]
  vec3 translation{0.0f};  ///< [m]
  float angle = 0;         ///< [rad], counter-clockwise seen from the axis's tip; more than a turn is meant as it is said
  vec3 scale{1.0f};        ///< along x, y, z of the rest pose; above 0
};

/// Moves objects together. Between keys everything runs linearly, or eased (smoothstep) where `eased`. An object that several animations name goes through
/// them in their order.
struct ObjectAnimation {
  std::string name;
  std::vector<uint32_t> objects;  ///< indices into Scene::objects
  vec3 pivot{0.0f}, axis{0, 1, 0};  ///< in the rest pose [m]; unit
  Repeat repeat = Repeat::Loop;
  bool eased = false;
  std::vector<PoseKey> keys;      ///< at least one; the first at time 0, times ascend
};

struct LightKey {
  float time = 0;
  vec3 position{0.0f}, direction{0, -1, 0};
  float factor = 1;               ///< of the light's own intensity or irradiance
};

/// Moves, turns or dims the punctual light of that name.
struct LightAnimation {
  std::string light;
  bool movesPosition = false, turnsDirection = false, scalesIntensity = false;  ///< what the keys say; the rest stays as the light has it
  Repeat repeat = Repeat::Loop;
  bool eased = false;
  std::vector<LightKey> keys;     ///< as an ObjectAnimation's
};

struct CameraKey {
  float time = 0;
  Camera camera;
};

/// A recorded flight. Positions, targets and the rest follow a cubic through the keys (Catmull and Rom, with the keys' times).
struct CameraPath {
  std::string name;
  Repeat repeat = Repeat::Once;
  std::vector<CameraKey> keys;    ///< as an ObjectAnimation's
};

/// A named rectangle of the image, as fractions of its size.
struct Region {
  std::string name;
  float x = 0, y = 0, width = 1, height = 1;
  bool operator==(const Region&) const = default;
};

/// @throws Error(BadInput) for one that is empty or reaches beyond the picture, and for names that are missing or not their own.
void checkRegions(const std::vector<Region>&);

inline constexpr float kFarthestProbe = 1e9f;  ///< [m] along an axis
/// @throws Error(BadInput) for one that is not finite or farther away than kFarthestProbe, by its number from 1.
void checkProbes(const std::vector<vec3>&);

/// What the import changed or passed over; shown by doctor and the Scene dock.
struct ImportReport {
  uint64_t degenerateTriangles = 0;  ///< zero-area triangles, dropped
  uint64_t cappedAlbedo = 0;         ///< materials whose albedo exceeded kMaxAlbedo
  uint64_t cappedSpecular = 0;       ///< materials whose albedo and specular reflectance together exceeded 1
  uint64_t missingTextures = 0;
  vec3 recentred{0.0f};              ///< subtracted from every position where the scene lay far from the origin
  std::vector<std::string> warnings;
};

struct Scene {
  std::string name;
  std::filesystem::path source;  ///< the file it came from
  std::string hash;              ///< content: geometry, materials, textures, lights, sky

  std::vector<vec3> positions, normals;  ///< one normal a vertex, unit; generated where the file has none
  std::vector<vec2> uvs;                 ///< texture coordinates, v upwards as in OBJ; zero where the file has none
  std::vector<vec2> lightmapUvs;         ///< the file's second UV set; empty where it has none
  bool hasUvs = false;
  std::vector<uvec3> indices;
  std::vector<uint32_t> materialIds, objectIds;  ///< one a triangle
  std::vector<std::string> objects;
  std::vector<Material> materials;
  std::vector<Texture> textures;

  std::vector<PointLight> pointLights;
  std::vector<SpotLight> spotLights;
  std::vector<DirectionalLight> directionalLights;
  vec3 sky{0.0f};  ///< radiance from every direction that hits nothing
  Environment environment;

  std::vector<Camera> cameras;  ///< at least one after loading
  std::vector<Region> regions;
  std::vector<vec3> probes;     ///< those set by hand [m]; no part of the content that `hash` tells

  std::vector<ObjectAnimation> animations;        ///< geometry above is the rest pose, until a ScenePose brings it to a moment
  std::vector<LightAnimation> lightAnimations;
  std::vector<CameraPath> cameraPaths;
  Bounds bounds;                ///< of all poses, where objects move
  ImportReport report;

  size_t triangles() const { return indices.size(); }
};

/// What the scene has, so that passes and shader variants do only what it needs.
struct SceneFeatures {
  bool surfaces = false, emissive = false, pointLights = false, spotLights = false, directionalLights = false, sky = false, environment = false;
  bool alphaTested = false, albedoTextures = false, normalMaps = false, twoSided = false;
  bool glossySurfaces = false;
  bool movingObjects = false, movingLights = false;  ///< at some time
  uint32_t emissiveTriangles = 0;
  bool anyLight() const { return emissive || pointLights || spotLights || directionalLights || sky || environment; }
};
SceneFeatures sceneFeatures(const Scene&);

}  // namespace hl
