#include "engine/scene/gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/gpu/device.h"
#include "engine/scene/environment.h"
#include "engine/scene/scene_pose.h"
#include "shaders/shared/scene_types.h"

namespace hl {
namespace {

template <class T>
Buffer upload(Device& device, const char* name, const std::vector<T>& data) {
  const uint64_t bytes = data.size() * sizeof(T);
  if (bytes > device.maxStorageBufferBytes())
    throw Error(ErrorKind::TooLarge, fmt::format("the scene's {} take {} MiB, this device's buffers hold {}", name,
                                               bytes >> 20, device.maxStorageBufferBytes() >> 20));
  return device.buffer(name, std::span<const T>(data));
}

bool emits(const Material& m) { return m.emission.x > 0 || m.emission.y > 0 || m.emission.z > 0; }

std::vector<shared::GpuMaterial> materials(const Scene& scene, const GpuScene& gpu) {
  std::vector<shared::GpuMaterial> out;
  const vec2 layer(static_cast<float>(gpu.textures.width()), static_cast<float>(gpu.textures.height()));
  const auto share = [&](uint32_t texture) {
    if (texture == kNone) return vec2(1.0f);
    const Texture& t = scene.textures[texture];
    return vec2(static_cast<float>(t.width), static_cast<float>(t.height)) / layer;
  };
  for (const Material& m : scene.materials) {
    shared::GpuMaterial g{};
    g.albedo = m.albedo, g.emission = m.emission, g.alphaCutoff = m.alphaCutoff;
    g.flags = (m.twoSided ? shared::kMaterialTwoSided : 0u) | (emits(m) ? shared::kMaterialEmissive : 0u);
    g.albedoTexture = m.albedoTexture, g.normalTexture = m.normalTexture;
    g.specular = m.specular, g.roughness = m.roughness;
    g.albedoUvScale = share(m.albedoTexture), g.normalUvScale = share(m.normalTexture);
    out.push_back(g);
  }
  return out;
}

std::vector<shared::GpuLight> lights(const Scene& scene) {
  std::vector<shared::GpuLight> out;
  for (const PointLight& l : scene.pointLights)
    out.push_back({l.position, shared::kLightPoint, vec3(0, -1, 0), 1, l.intensity, -1});
  for (const SpotLight& l : scene.spotLights)
    out.push_back(
        {l.position, shared::kLightSpot, l.direction, std::cos(l.innerAngle), l.intensity, std::cos(l.outerAngle)});
  for (const DirectionalLight& l : scene.directionalLights)
    out.push_back({vec3(0.0f), shared::kLightDirectional, l.direction, 1, l.irradiance, -1});
  return out;
}

std::vector<shared::GpuEmitter> emitters(const Scene& scene, float& power) {
  std::vector<shared::GpuEmitter> out;
  std::vector<double> powers;
  double total = 0;
  for (size_t t = 0; t < scene.indices.size(); ++t) {
    const Material& m = scene.materials[scene.materialIds[t]];
    if (!emits(m)) continue;
    const uvec3 i = scene.indices[t];
    shared::GpuEmitter e{};
    e.p0 = scene.positions[i.x], e.p1 = scene.positions[i.y], e.p2 = scene.positions[i.z];
    e.triangle = static_cast<uint32_t>(t);
    e.emission = m.emission;
    e.area = 0.5f * glm::length(glm::cross(e.p1 - e.p0, e.p2 - e.p0));
    out.push_back(e);
    powers.push_back(static_cast<double>(e.area) * static_cast<double>(luminance(m.emission)));
    total += powers.back();
  }
  double before = 0;
  for (size_t k = 0; k < out.size(); ++k) {
    out[k].probability = static_cast<float>(powers[k] / total);
    out[k].cumulative = static_cast<float>(before / total);
    before += powers[k];
  }
  power = static_cast<float>(total);
  return out;
}

GpuImage textures(Device& device, const Scene& scene, uint64_t& bytes) {
  ImageDesc d;
  d.format = Format::RGBA8;
  d.width = 1, d.height = 1;
  for (const Texture& t : scene.textures) d.width = std::max(d.width, t.width), d.height = std::max(d.height, t.height);
  d.layers = std::max(2, static_cast<int>(scene.textures.size()));  // an array view needs more than one
  const GpuImage image = device.image("scene textures", d);
  const size_t row = static_cast<size_t>(d.width) * 4;
  std::vector<uint8_t> layer(row * static_cast<size_t>(d.height), 255);
  for (int i = 0; i < d.layers; ++i) {
    if (static_cast<size_t>(i) < scene.textures.size()) {
      // The texture fills the layer's upper left corner; shaders repeat and filter within it.
      const Texture& t = scene.textures[static_cast<size_t>(i)];
      for (size_t y = 0; y < static_cast<size_t>(t.height); ++y)
        std::copy_n(t.rgba.data() + y * static_cast<size_t>(t.width) * 4, static_cast<size_t>(t.width) * 4,
                    layer.data() + y * row);
    }
    device.upload(image, i, layer.data(), layer.size());
  }
  bytes = layer.size() * static_cast<uint64_t>(d.layers);
  return image;
}

}  // namespace

GpuScene uploadScene(Device& device, const Scene& scene) {
  GpuScene g;
  g.positions = upload(device, "positions", scene.positions);
  g.normals = upload(device, "normals", scene.normals);
  g.uvs = upload(device, "uvs", scene.uvs);
  g.indices = upload(device, "indices", scene.indices);
  g.materialIds = upload(device, "material_ids", scene.materialIds);
  g.objectIds = upload(device, "object_ids", scene.objectIds);
  g.objectCount = static_cast<uint32_t>(scene.objects.size());
  shared::ObjectTransform still{};
  still.restToWorld = still.previousRestToWorld = still.worldToRest = mat4(1.0f);
  g.objectTransforms = upload(device, "object_transforms", std::vector<shared::ObjectTransform>(scene.objects.size(), still));
  const ScenePose rest(scene);
  if (rest.movesGeometry()) g.movingVertices = upload(device, "moving_vertices", rest.vertices());
  g.movingVertexCount = static_cast<uint32_t>(rest.vertices().size());
  if (rest.movesGeometry()) updateTransforms(device, g, rest.transforms());
  g.textures = textures(device, scene, g.textureBytes);
  g.triangleCount = static_cast<uint32_t>(scene.indices.size());
  g.diagonal = scene.bounds.diagonal();
  const EnvironmentLight environment(scene.environment);
  g.environmentTexels = upload(device, "environment", environment.texels());
  g.environmentTable = upload(device, "environment_table", environment.table());
  if (environment.shines()) g.environment = environment.info();
  updateLights(device, g, scene);
  return g;
}

void updateTransforms(Device& device, GpuScene& g, std::span<const shared::ObjectTransform> transforms) {
  if (transforms.size() != g.objectCount)
    throw Error(ErrorKind::Run, fmt::format("{} transforms for {} objects", transforms.size(), g.objectCount));
  if (!transforms.empty()) device.upload(g.objectTransforms, transforms.data(), transforms.size_bytes());
}

void updateEmitters(Device& device, GpuScene& g, const Scene& scene) {
  const std::vector<shared::GpuEmitter> e = emitters(scene, g.emitterPower);
  if (!e.empty()) device.upload(g.emitters, e.data(), e.size() * sizeof(shared::GpuEmitter));
}

void updateLights(Device& device, GpuScene& g, const Scene& scene) {
  const std::vector<shared::GpuLight> l = lights(scene);
  const std::vector<shared::GpuEmitter> e = emitters(scene, g.emitterPower);
  g.lights = upload(device, "lights", l);
  g.emitters = upload(device, "emitters", e);
  g.materials = upload(device, "materials", materials(scene, g));
  g.lightCount = static_cast<uint32_t>(l.size());
  g.emitterCount = static_cast<uint32_t>(e.size());
  g.sky = scene.sky;
  g.features = sceneFeatures(scene);
}

std::vector<std::pair<std::string, uint64_t>> GpuScene::memory() const {
  std::vector<std::pair<std::string, uint64_t>> out;
  for (const Buffer* b :
       {&positions, &normals, &uvs, &indices, &materialIds, &objectIds, &objectTransforms, &movingVertices, &materials, &lights, &emitters, &environmentTexels, &environmentTable})
    if (*b) out.emplace_back(b->name(), b->size());
  if (textures) out.emplace_back(textures.name(), textureBytes);
  return out;
}

}  // namespace hl
