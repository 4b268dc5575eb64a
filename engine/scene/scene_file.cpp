#include "engine/scene/scene_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/core/files.h"
#include "engine/scene/environment.h"
#include "engine/scene/mesh_import.h"
#include "engine/scene/scene_build.h"
#include "engine/scene/scene_bundle.h"
#include "engine/scene/scene_description.h"
#include "engine/scene/scene_search.h"
#include "engine/scene/shapes.h"

namespace hl {
namespace {

/// A bare mesh has no light of its own choosing: a sun from above and the side, and a dim sky.
void lightBareMesh(Scene& scene) {
  if (sceneFeatures(scene).anyLight()) return;
  scene.directionalLights.push_back({"sun", glm::normalize(vec3(-0.4f, -0.8f, -0.45f)), vec3(3.0f)});
  scene.sky = vec3(0.4f, 0.45f, 0.5f);
}

uint32_t materialNamed(Scene& scene, const std::string& name, bool add) {
  for (uint32_t i = 0; i < scene.materials.size(); ++i)
    if (scene.materials[i].name == name) return i;
  if (!add) return kNone;
  scene.materials.push_back({});
  scene.materials.back().name = name;
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

void override(Material& m, const MaterialOverride& o) {
  if (o.albedo) m.albedo = *o.albedo;
  if (o.emission) m.emission = *o.emission;
  if (o.specular) m.specular = *o.specular;
  if (o.roughness) m.roughness = *o.roughness;
  if (o.twoSided) m.twoSided = *o.twoSided;
  if (o.alphaCutoff) m.alphaCutoff = *o.alphaCutoff;
}

/// Materials of the mesh are changed; those that shapes name are made. One that neither has is a slip of the pen.
void applyMaterials(Scene& scene, const SceneDescription& d, const std::string& file) {
  std::vector<std::string> wanted;
  for (const Shape& s : d.shapes) {
    if (!s.material.empty()) wanted.push_back(s.material);
    for (const auto& [face, material] : s.faceMaterials) wanted.push_back(material);
  }
  std::vector<std::string> defined, usable = wanted;
  for (const Material& m : scene.materials) usable.push_back(m.name), defined.push_back(m.name);
  for (const auto& [name, o] : d.materials) {
    const bool used = std::find(usable.begin(), usable.end(), name) != usable.end();
    if (!used) {
      const std::string near = nearest(name, usable);
      throw badInput(fmt::format("{}: materials.{}: neither the mesh nor a shape has this material{}", file, name,
                                 near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
    override(scene.materials[materialNamed(scene, name, true)], o);
    defined.push_back(name);
  }
  for (const std::string& name : wanted)
    if (std::find(defined.begin(), defined.end(), name) == defined.end()) {
      const std::string near = nearest(name, defined);
      throw badInput(fmt::format("{}: a shape's material '{}' is not under 'materials'{}", file, name,
                                 near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
}

/// The objects that an animation's names mean.
std::vector<uint32_t> objectsNamed(const Scene& scene, const std::vector<std::string>& names, const std::string& place) {
  std::vector<uint32_t> out;
  for (const std::string& name : names) {
    const bool group = name.ends_with('*');
    bool found = false;
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
      const bool same = group ? scene.objects[i].starts_with(name.substr(0, name.size() - 1)) : scene.objects[i] == name;
      found = found || same;
      if (same && std::find(out.begin(), out.end(), i) == out.end()) out.push_back(i);
    }
    if (found) continue;
    const std::string near = nearest(name, scene.objects);
    throw badInput(fmt::format("{}.objects: there is no object '{}'{}", place, name, near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
  }
  return out;
}

void applyAnimations(Scene& scene, const SceneDescription& d) {
  for (const AnimationDescription& a : d.animations) {
    scene.animations.push_back(a.animation);
    scene.animations.back().objects = objectsNamed(scene, a.objects, a.place);
  }
  for (const auto& [place, a] : d.lightAnimations) {
    std::vector<std::string> names;
    bool fits = false, known = false;
    const auto look = [&](const auto& lights, bool hasPosition, bool hasDirection) {
      for (const auto& l : lights) {
        names.push_back(l.name);
        if (l.name != a.light) continue;
        known = true;
        fits = (!a.movesPosition || hasPosition) && (!a.turnsDirection || hasDirection);
      }
    };
    look(scene.pointLights, true, false), look(scene.spotLights, true, true), look(scene.directionalLights, false, true);
    if (!known) {
      const std::string near = nearest(a.light, names);
      throw badInput(fmt::format("{}.light: there is no light '{}'{}", place, a.light, near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
    if (!fits)
      throw badInput(fmt::format("{}.keys: light '{}' has no {} to animate", place, a.light, a.turnsDirection ? "direction" : "position"));
    scene.lightAnimations.push_back(a);
  }
  scene.cameraPaths = d.cameraPaths;
}

Scene fromDescription(const SceneDescription& d, const std::filesystem::path& file, Progress* progress) {
  Scene scene;
  if (d.mesh) scene = importMeshCached(findMesh(*d.mesh, file), d.mesh->scale, progress);
  if (d.mesh && d.mesh->vDown)
    for (vec2& uv : scene.uvs) uv.y = 1 - uv.y;
  scene.name = file.stem().string();
  applyMaterials(scene, d, file.string());
  appendShapes(scene, d.shapes, d.lightmapUvs,
               [&](const std::string& name) { return materialNamed(scene, name, false); });
  scene.pointLights = d.pointLights;
  scene.spotLights = d.spotLights;
  scene.directionalLights = d.directionalLights;
  scene.sky = d.sky;
  if (d.environment) {
    uint64_t negative = 0;
    scene.environment = loadEnvironment(findEnvironment(*d.environment, file), negative);
    scene.environment.rotation = d.environment->rotation, scene.environment.scale = d.environment->scale;
    if (negative > 0) scene.report.warnings.push_back(fmt::format("{}: {} texels below 0 count as 0", scene.environment.file, negative));
  }
  scene.cameras = d.cameras;
  scene.regions = d.regions;
  scene.probes = d.probes;
  applyAnimations(scene, d);
  return scene;
}

}  // namespace

Scene loadScene(const std::string& nameOrPath, Progress* progress, const std::filesystem::path& beside) {
  if (isBundleFile(beside)) {
    const Archive bundle(beside, kBundleKind);
    if (bundle.has(bundledScenePart(nameOrPath))) return bundledScene(bundle, nameOrPath);
    return loadScene(nameOrPath, progress, beside.parent_path());
  }
  const std::filesystem::path file = findScene(nameOrPath, beside);
  if (isBundleFile(file)) {
    const Archive bundle(file, kBundleKind);
    return bundledScene(bundle, onlyScene(bundle));
  }
  Scene scene;
  if (isMeshFile(file)) {
    scene = importMeshCached(file, 1, progress);
    scene.name = file.stem().string();
    lightBareMesh(scene);
  } else {
    scene = fromDescription(parseSceneDescription(readFile(file), file), file, progress);
  }
  scene.source = file;
  finishScene(scene);
  return scene;
}

}  // namespace hl
