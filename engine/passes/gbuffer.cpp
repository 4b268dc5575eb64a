#include "engine/passes/gbuffer.h"

#include <cmath>

namespace hl {
namespace {

/// Nothing nearer to the camera than this share of the distance to its target is drawn. Reversed floating-point depth
/// loses nothing to so near a plane.
constexpr float kNearShare = 1e-5f;

/// As gbuffer.glsl declares it.
struct CameraConstants {
  mat4 worldToClip;
  vec3 origin, forward, right, down;
  vec2 size;
};
static_assert(sizeof(CameraConstants) == 120);

}  // namespace

CameraBasis cameraBasis(const Camera& camera, float aspect) {
  CameraBasis b;
  b.origin = camera.position;
  const vec3 towards = camera.target - camera.position;
  const float distance = glm::length(towards);
  b.forward = distance > 0 ? towards / distance : vec3(0, 0, -1);
  vec3 right = glm::cross(b.forward, camera.up);
  // Looking along `up`, any direction across will do.
  if (glm::dot(right, right) < 1e-12f)
    right = glm::cross(b.forward, std::abs(b.forward.x) < 0.5f ? vec3(1, 0, 0) : vec3(0, 0, 1));
  right = glm::normalize(right);
  const float half = std::tan(0.5f * camera.verticalFov);
  b.right = half * aspect * right;
  b.down = half * glm::cross(b.forward, right);
  b.nearPlane = kNearShare * (distance > 0 ? distance : 1.0f);
  return b;
}

vec3 pixelDirection(const CameraBasis& b, float x, float y, int width, int height) {
  return b.forward + (2 * x / static_cast<float>(width) - 1) * b.right +
         (2 * y / static_cast<float>(height) - 1) * b.down;
}

mat4 cameraMatrix(const Camera& camera, float aspect) {
  const CameraBasis b = cameraBasis(camera, aspect);
  const vec3 right = b.right / glm::dot(b.right, b.right), down = b.down / glm::dot(b.down, b.down);
  mat4 m(0.0f);
  // Rows: x, y, z and w of clip space; GLM stores columns.
  const vec3 rows[] = {right, down, vec3(0), b.forward};
  const float constants[] = {-glm::dot(right, b.origin), -glm::dot(down, b.origin), b.nearPlane,
                             -glm::dot(b.forward, b.origin)};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 3; ++column) m[column][row] = rows[row][column];
    m[3][row] = constants[row];
  }
  return m;
}

GBuffer recordGBuffer(FrameGraph& graph, const GpuScene& scene, const Buffer& cornerUvs, const Camera& camera,
                      int width, int height) {
  const auto image = [&](const char* name, Format format) { return graph.transient(name, {width, height, format}); };
  GBuffer g;
  g.width = width, g.height = height;
  g.position = image("gbuffer.position", Format::RGBA32F);
  g.normal = image("gbuffer.normal", Format::RGBA32F);
  g.geometricNormal = image("gbuffer.geometricNormal", Format::RGBA32F);
  g.albedo = image("gbuffer.albedo", Format::RGBA32F);
  g.emission = image("gbuffer.emission", Format::RGBA32F);
  g.ids = image("gbuffer.ids", Format::RG32U);

  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const CameraBasis basis = cameraBasis(camera, aspect);
  const CameraConstants constants{cameraMatrix(camera, aspect),
                                  basis.origin,
                                  basis.forward,
                                  basis.right,
                                  basis.down,
                                  vec2(static_cast<float>(width), static_cast<float>(height))};
  graph
      .raster("gbuffer: visibility", "passes/visibility.vert", "passes/visibility.frag",
              {{g.ids}, image("gbuffer.depth", Format::D32F)})
      .bind("positions", scene.positions, Access::Read)
      .bind("uvs", scene.uvs, Access::Read)
      .bind("indices", scene.indices, Access::Read)
      .bind("materials", scene.materials, Access::Read)
      .bind("materialIds", scene.materialIds, Access::Read)
      .sample("textures", scene.textures)
      .specialize("kAlphaTested", scene.features.alphaTested ? 1 : 0)
      .push(constants)
      .draw(3 * scene.triangleCount);
  graph
      .raster("gbuffer: surfaces", "passes/surfaces.vert", "passes/surfaces.frag",
              {{g.position, g.normal, g.geometricNormal, g.albedo, g.emission}, GpuImage()})
      .bind("positions", scene.positions, Access::Read)
      .bind("normals", scene.normals, Access::Read)
      .bind("uvs", scene.uvs, Access::Read)
      .bind("indices", scene.indices, Access::Read)
      .bind("materials", scene.materials, Access::Read)
      // Without a lightmap another buffer of pairs stands in, and is never read.
      .bind("cornerUvs", cornerUvs ? cornerUvs : scene.uvs, Access::Read)
      .sample("textures", scene.textures)
      .sample("ids", g.ids)
      .specialize("kTextured", scene.features.albedoTextures ? 1 : 0)
      .specialize("kNormalMaps", scene.features.normalMaps ? 1 : 0)
      .specialize("kLightmap", cornerUvs ? 1 : 0)
      .push(constants)
      .draw(3);
  if (!scene.features.glossySurfaces) {
    graph.skip("gbuffer: specular", "scene has no glossy surfaces");
    return g;
  }
  g.specular = image("gbuffer.specular", Format::RGBA32F);
  // An image of its own pass: devices need to have no more than four attachments, and scenes without gloss need no variant of the pass above.
  graph.raster("gbuffer: specular", "passes/surfaces.vert", "passes/specular.frag", {{g.specular}, GpuImage()})
      .bind("materials", scene.materials, Access::Read)
      .sample("position", g.position)
      .sample("ids", g.ids)
      .draw(3);
  return g;
}

void recordMotion(FrameGraph& graph, GBuffer& g, const GpuScene& scene, const Camera& now, const Camera& previous) {
  g.motion = graph.transient("gbuffer.motion", {g.width, g.height, Format::RG32F});
  const float aspect = static_cast<float>(g.width) / static_cast<float>(g.height);
  const CameraBasis basis = cameraBasis(now, aspect);
  const CameraConstants constants{cameraMatrix(previous, aspect),
                                  basis.origin,
                                  basis.forward,
                                  basis.right,
                                  basis.down,
                                  vec2(static_cast<float>(g.width), static_cast<float>(g.height))};
  const bool same = now.seesAs(previous);
  graph.raster("gbuffer: motion", "passes/surfaces.vert", "passes/motion.frag", {{g.motion}, GpuImage()})
      .sample("position", g.position)
      .sample("ids", g.ids)
      .bind("objectIds", scene.objectIds, Access::Read)
      .bind("objectTransforms", scene.objectTransforms, Access::Read)
      .specialize("kCameraMoved", same ? 0 : 1)
      .push(constants)
      .draw(3);
}

}  // namespace hl
