#include "engine/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/vector_relational.hpp>
#include <set>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/scene/animation.h"
#include "engine/scene/environment.h"
#include "engine/scene/scene_build.h"
#include "engine/scene/scene_pose.h"
#include "engine/scene/texture_sampling.h"

namespace hl {
namespace {

/// The highest value of each channel, linear.
vec3 brightest(const Texture& t) {
  uint8_t most[4] = {};
  for (size_t i = 0; i < t.rgba.size(); ++i) most[i % 4] = std::max(most[i % 4], t.rgba[i]);
  const auto& decode = srgbDecodeTable();
  return vec3(decode[most[0]], decode[most[1]], decode[most[2]]);
}

bool emits(const Material& m) { return m.emission.x > 0 || m.emission.y > 0 || m.emission.z > 0; }

void hashAnimations(Hasher& h, const Scene& scene) {
  h.value<uint64_t>(scene.animations.size());
  for (const ObjectAnimation& a : scene.animations) {
    h.array(a.objects).value(a.pivot).value(a.axis).value(static_cast<int>(a.repeat)).value<uint32_t>(a.eased);
    h.value<uint64_t>(a.keys.size());
    for (const PoseKey& k : a.keys) h.value(k.time).value(k.translation).value(k.angle).value(k.scale);
  }
  h.value<uint64_t>(scene.lightAnimations.size());
  for (const LightAnimation& a : scene.lightAnimations) {
    h.text(a.light).value<uint32_t>(a.movesPosition).value<uint32_t>(a.turnsDirection).value<uint32_t>(a.scalesIntensity);
    h.value(static_cast<int>(a.repeat)).value<uint32_t>(a.eased);
    h.value<uint64_t>(a.keys.size());
    for (const LightKey& k : a.keys) h.value(k.time).value(k.position).value(k.direction).value(k.factor);
  }
}

constexpr float kReflectanceSlack = 1e-6f;  // what rounding may add to albedo + specular
constexpr float kRegionSlack = 1e-4f;  // what rounding may add to x + width

}  // namespace

void checkRegions(const std::vector<Region>& regions) {
  std::set<std::string> names;
  for (const Region& r : regions) {
    const bool inside = r.x >= 0 && r.y >= 0 && r.width > 0 && r.height > 0 && r.x + r.width <= 1 + kRegionSlack && r.y + r.height <= 1 + kRegionSlack;
    if (!inside)
      throw badInput(fmt::format("region '{}': {:.4g},{:.4g} {:.4g} x {:.4g} reaches beyond the picture or is empty; shares of it in [0, 1] are wanted", r.name,
                                 r.x, r.y, r.width, r.height));
    if (r.name.empty() || !names.insert(r.name).second) throw badInput(fmt::format("region '{}': a name of its own is wanted", r.name));
  }
}

void checkProbes(const std::vector<vec3>& probes) {
  for (size_t i = 0; i < probes.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(probes[i][axis]) <= kFarthestProbe))
        throw badInput(fmt::format("probe {}: {} is no place; three numbers of metres are wanted, each within {:.0e} of 0", i + 1, probes[i][axis], kFarthestProbe));
}

SceneFeatures sceneFeatures(const Scene& scene) {
  SceneFeatures f;
  f.surfaces = !scene.indices.empty();
  std::vector<uint64_t> triangles(scene.materials.size(), 0);
  for (const uint32_t id : scene.materialIds) ++triangles[id];
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    if (triangles[i] == 0) continue;
    const Material& m = scene.materials[i];
    if (emits(m)) f.emissive = true, f.emissiveTriangles += static_cast<uint32_t>(triangles[i]);
    f.alphaTested = f.alphaTested || (m.alphaCutoff > 0 && m.albedoTexture != kNone);
    f.albedoTextures = f.albedoTextures || m.albedoTexture != kNone;
    f.normalMaps = f.normalMaps || m.normalTexture != kNone;
    f.twoSided = f.twoSided || m.twoSided;
    f.glossySurfaces = f.glossySurfaces || m.glossy();
  }
  f.pointLights = !scene.pointLights.empty();
  f.spotLights = !scene.spotLights.empty();
  f.directionalLights = !scene.directionalLights.empty();
  f.movingObjects = f.surfaces && !scene.animations.empty();
  f.movingLights = !scene.lightAnimations.empty();
  f.sky = scene.sky.x > 0 || scene.sky.y > 0 || scene.sky.z > 0;
  f.environment = EnvironmentLight(scene.environment).shines();
  return f;
}

std::string sceneContentHash(const Scene& scene) {
  Hasher h;
  h.array(scene.positions).array(scene.normals).array(scene.uvs).array(scene.lightmapUvs);
  h.array(scene.indices).array(scene.materialIds).array(scene.objectIds);
  h.value<uint64_t>(scene.materials.size());
  for (const Material& m : scene.materials) {
    h.value(m.albedo).value(m.emission).value(m.albedoTexture).value(m.normalTexture);
    h.value(m.alphaCutoff).value<uint32_t>(m.twoSided);
  }
  h.value<uint64_t>(scene.textures.size());
  for (const Texture& t : scene.textures) h.value(t.width).value(t.height).value<uint32_t>(t.srgb).array(t.rgba);
  h.value<uint64_t>(scene.pointLights.size());
  for (const PointLight& l : scene.pointLights) h.value(l.position).value(l.intensity);
  h.value<uint64_t>(scene.spotLights.size());
  for (const SpotLight& l : scene.spotLights)
    h.value(l.position).value(l.direction).value(l.intensity).value(l.innerAngle).value(l.outerAngle);
  h.value<uint64_t>(scene.directionalLights.size());
  for (const DirectionalLight& l : scene.directionalLights) h.value(l.direction).value(l.irradiance);
  h.value(scene.sky);
  // Scenes without any keep the hash they had.
  if (!scene.environment.empty()) {
    const Environment& e = scene.environment;
    h.value(e.width).value(e.height).array(e.radiance).value(e.rotation).value(e.scale);
  }
  // Scenes without any keep the hash they had.
  if (animated(scene)) hashAnimations(h, scene);
  for (size_t i = 0; i < scene.materials.size(); ++i)
    if (const Material& m = scene.materials[i]; m.glossy()) h.text("glossy").value<uint64_t>(i).value(m.specular).value(m.roughness);
  return h.hex();
}

void recentreScene(Scene& scene) {
  if (scene.bounds.empty()) return;
  const vec3 centre = scene.bounds.centre();
  const float diagonal = scene.bounds.diagonal();
  if (!(diagonal > 0) || glm::length(centre) <= kRecentreDistance * diagonal) return;
  // Whole multiples of the diagonal's power of two: the subtraction is then exact wherever a float still has the bits.
  const float step = std::exp2(std::ceil(std::log2(diagonal)));
  const vec3 shift = glm::floor(centre / step + 0.5f) * step;
  for (vec3& p : scene.positions) p -= shift;
  for (PointLight& l : scene.pointLights) l.position -= shift;
  for (SpotLight& l : scene.spotLights) l.position -= shift;
  for (Camera& c : scene.cameras) c.position -= shift, c.target -= shift;
  for (vec3& p : scene.probes) p -= shift;
  for (ObjectAnimation& a : scene.animations) a.pivot -= shift;
  for (LightAnimation& a : scene.lightAnimations)
    for (LightKey& k : a.keys) k.position -= shift;
  for (CameraPath& p : scene.cameraPaths)
    for (CameraKey& k : p.keys) k.camera.position -= shift, k.camera.target -= shift;
  scene.bounds.min -= shift, scene.bounds.max -= shift;
  scene.report.recentred += shift;
}

void finishScene(Scene& scene) {
  scene.bounds = {};
  // Of the triangles, not of the vertices: a stray vertex that nothing uses is no part of the scene.
  for (const uvec3 t : scene.indices)
    for (const uint32_t v : {t.x, t.y, t.z}) scene.bounds.extend(scene.positions[v]);
  for (Material& m : scene.materials) {
    const vec3 highest =
        m.albedo * (m.albedoTexture == kNone ? vec3(1.0f) : brightest(scene.textures[m.albedoTexture]));
    if (!glm::all(glm::lessThanEqual(highest, vec3(kMaxAlbedo)))) {
      ++scene.report.cappedAlbedo;
      // With a texture it is the product that is capped, where it is looked up.
      if (m.albedoTexture == kNone) m.albedo = glm::min(m.albedo, vec3(kMaxAlbedo));
    }
    // What is reflected both ways can't be more than what arrives: at normal incidence, for the texture's brightest texel.
    const vec3 left = vec3(1.0f) - glm::min(highest, vec3(kMaxAlbedo));
    if (glm::all(glm::lessThanEqual(m.specular, left + kReflectanceSlack))) continue;
    ++scene.report.cappedSpecular;
    const vec3 asked = m.specular;
    m.specular = glm::min(m.specular, left);
    scene.report.warnings.push_back(fmt::format("material '{}': albedo and specular together reflect more than arrives; specular {:.3g}, {:.3g}, {:.3g} counts as {:.3g}, {:.3g}, {:.3g}", m.name, asked.x, asked.y, asked.z,
                                                m.specular.x, m.specular.y, m.specular.z));
  }
  if (!scene.animations.empty()) {
    separateMovingVertices(scene);
    scene.bounds = boundsOfPoses(scene);
  }
  recentreScene(scene);
  if (scene.cameras.empty()) scene.cameras.push_back(sensibleCamera(scene));
  scene.hash = sceneContentHash(scene);
}

}  // namespace hl
