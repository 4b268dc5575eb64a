#pragma once
// What a scene file says, before any geometry is made. Lengths in metres, angles in radians once read (files have
// degrees).
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.h"

namespace hl {

struct MeshReference {
  std::string file;    ///< looked for beside the scene file, then along HALFLIGHT_SCENES
  double scale = 1;    ///< metres a unit of the file
  bool vDown = false;    ///< the file counts texture v from the top of the image; turned round on loading
  std::string obtain;  ///< where to get it, for the message when it is missing
};

struct EnvironmentReference {
  std::string file;      ///< looked for as a mesh is
  float rotation = 0;    ///< [rad]
  vec3 scale{1.0f};
  std::string obtain;
};

enum class ShapeType { Quad, Box, UvSphere, Icosphere, Lathe, Arch, Cloth };

/// A procedural surface. Faces look inward or outward; each face is a chart of the lightmap where those are asked for.
struct Shape {
  ShapeType type = ShapeType::Quad;
  std::string name, material;
  std::vector<vec3> corners;                         ///< quad: 4, counter-clockwise seen from the front
  vec3 min{0.0f}, max{1.0f};                         ///< box
  std::vector<std::string> faces;                    ///< box: those present, of kBoxFaces; empty means all six
  std::map<std::string, std::string> faceMaterials;  ///< box: exceptions from `material`
  vec3 centre{0.0f};                                 ///< spheres
  float radius = 1;
  bool inward = false;   ///< box and spheres: the front looks at the inside
  bool smooth = false;   ///< spheres: vertex normals of the sphere instead of the facets'
  int subdivisions = 1;  ///< pieces an edge: of a face, of a base triangle; rings of a uv_sphere; sectors of a lathe; segments of an arch's half circle
  std::vector<vec2> profile;  ///< lathe: (radius, height above `centre`) from below, turned about the vertical
  bool alongX = true;         ///< arch: the wall runs along x, and one goes through it along z; else the other way round
  int folds = 0;              ///< cloth over `corners`: waves along its first edge, deepest there and shallow at the opposite one, which it hangs from
  float depth = 0, sag = 0;   ///< of the folds along the normal, and of the middle downwards [m]
};
/// What `copies` of a scene file may make: shapes, and triangles of them, about.
inline constexpr size_t kMostShapes = 20000, kMostShapeTriangles = size_t{1} << 23;
inline constexpr const char* kBoxFaces[6] = {"-x", "+x", "-y", "+y", "-z", "+z"};

/// Replaces what a mesh says of a material, or makes a new one that shapes use.
struct MaterialOverride {
  std::optional<vec3> albedo, emission, specular;
  std::optional<float> roughness;
  std::optional<bool> twoSided;
  std::optional<float> alphaCutoff;
};

/// An animation whose objects are still names: exact ones, or with a * at the end all that begin so.
struct AnimationDescription {
  std::string place;  ///< "animations[0]", for messages
  std::vector<std::string> objects;
  ObjectAnimation animation;
};

struct SceneDescription {
  std::string label;
  std::optional<MeshReference> mesh;
  std::vector<Shape> shapes;
  bool lightmapUvs = false;  ///< shapes get a second UV set: one chart a face, without overlaps
  std::vector<std::pair<std::string, MaterialOverride>> materials;
  std::vector<PointLight> pointLights;
  std::vector<SpotLight> spotLights;
  std::vector<DirectionalLight> directionalLights;
  vec3 sky{0.0f};
  std::optional<EnvironmentReference> environment;
  std::vector<Camera> cameras;
  std::vector<Region> regions;
  std::vector<vec3> probes;
  std::vector<AnimationDescription> animations;
  std::vector<std::pair<std::string, LightAnimation>> lightAnimations;  ///< with their places
  std::vector<CameraPath> cameraPaths;
};

/// @throws Error(BadInput): "<file>: <place>: <what is wrong>; <what would be right>".
SceneDescription parseSceneDescription(std::string_view text, const std::filesystem::path& file);

}  // namespace hl
