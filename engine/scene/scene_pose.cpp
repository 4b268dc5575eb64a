#include "engine/scene/scene_pose.h"

#include <algorithm>
#include <map>

#include "engine/scene/animation.h"

namespace hl {
namespace {

std::vector<bool> movingObjects(const Scene& scene) {
  std::vector<bool> moving(scene.objects.size());
  for (const ObjectAnimation& a : scene.animations)
    for (const uint32_t o : a.objects) moving[o] = true;
  return moving;
}

bool sameKey(const LightKey& a, const LightKey& b) { return a.position == b.position && a.direction == b.direction && a.factor == b.factor; }

}  // namespace

std::vector<bool> movingTriangles(const Scene& scene) {
  if (scene.animations.empty()) return {};
  const std::vector<bool> objects = movingObjects(scene);
  std::vector<bool> out(scene.indices.size());
  bool any = false;
  for (size_t t = 0; t < out.size(); ++t) out[t] = objects[scene.objectIds[t]], any = any || out[t];
  return any ? out : std::vector<bool>{};
}

void separateMovingVertices(Scene& scene) {
  if (scene.animations.empty()) return;
  const std::vector<bool> objects = movingObjects(scene);
  std::vector<uint32_t> owner(scene.positions.size(), kNone);
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;  // (vertex, object)
  for (size_t t = 0; t < scene.indices.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      uint32_t& v = scene.indices[t][k];
      const uint32_t object = scene.objectIds[t];
      if (owner[v] == kNone) owner[v] = object;
      if (owner[v] == object || (!objects[object] && !objects[owner[v]])) continue;
      const auto [at, isNew] = copies.try_emplace({v, object}, static_cast<uint32_t>(scene.positions.size()));
      if (isNew) {
        scene.positions.push_back(vec3(scene.positions[v]));
        scene.normals.push_back(vec3(scene.normals[v]));
        scene.uvs.push_back(vec2(scene.uvs[v]));
        if (!scene.lightmapUvs.empty()) scene.lightmapUvs.push_back(vec2(scene.lightmapUvs[v]));
        owner.push_back(object);
      }
      v = at->second;
    }
}

ScenePose::ScenePose(const Scene& scene) {
  setLights(scene);
  movesLights_ = !scene.lightAnimations.empty();
  shared::ObjectTransform still{};
  still.restToWorld = still.previousRestToWorld = still.worldToRest = mat4(1.0f);
  transforms_.assign(scene.objects.size(), still);
  poses_.assign(scene.objects.size(), mat4(1.0f));
  if (scene.animations.empty()) return;
  const std::vector<bool> objects = movingObjects(scene);
  for (size_t o = 0; o < objects.size(); ++o) transforms_[o].movable = objects[o] ? 1 : 0;
  std::vector<uint32_t> owner(scene.positions.size(), kNone);
  for (size_t t = 0; t < scene.indices.size(); ++t) {
    const uint32_t object = scene.objectIds[t];
    if (!objects[object]) continue;
    for (const uint32_t v : {scene.indices[t].x, scene.indices[t].y, scene.indices[t].z}) owner[v] = object;
  }
  for (uint32_t v = 0; v < owner.size(); ++v)
    if (owner[v] != kNone) vertices_.push_back({scene.positions[v], v, scene.normals[v], owner[v]});
}

void ScenePose::setLights(const Scene& scene) {
  rest_ = {scene.pointLights, scene.spotLights, scene.directionalLights};
  lightsStale_ = true;
}

void ScenePose::restLights(Scene& scene) const {
  scene.pointLights = rest_.points, scene.spotLights = rest_.spots, scene.directionalLights = rest_.directionals;
}

ScenePose::Changed ScenePose::apply(Scene& scene, double time) {
  Changed changed;
  if (movesLights_) changed = poseLights(scene, time);
  if (!movesGeometry()) return changed;
  std::vector<mat4> now = posesAt(scene, time);
  for (size_t o = 0; o < now.size(); ++o) {
    shared::ObjectTransform& t = transforms_[o];
    const bool moved = now[o] != poses_[o];
    changed.geometry = changed.geometry || moved;
    changed.transforms = changed.transforms || moved || t.moved != 0;
    t.previousRestToWorld = poses_[o];
    t.moved = moved ? 1 : 0;
    if (!moved) continue;
    t.restToWorld = now[o];
    t.worldToRest = glm::inverse(now[o]);
  }
  poses_ = std::move(now);
  if (changed.geometry) poseVertices(scene);
  return changed;
}

/// As shaders/passes/pose_vertices.comp does.
void ScenePose::poseVertices(Scene& scene) const {
  for (const shared::MovingVertex& v : vertices_) {
    const shared::ObjectTransform& t = transforms_[v.object];
    scene.positions[v.vertex] = vec3(t.restToWorld * glm::vec4(v.position, 1.0f));
    const vec3 n = glm::transpose(glm::mat3(t.worldToRest)) * v.normal;
    const float length = glm::length(n);
    scene.normals[v.vertex] = length > 0 ? n / length : v.normal;
  }
}

ScenePose::Changed ScenePose::poseLights(Scene& scene, double time) {
  std::vector<LightKey> keys;
  for (const LightAnimation& a : scene.lightAnimations) keys.push_back(lightAt(a, time));
  const bool same = !lightsStale_ && std::equal(keys.begin(), keys.end(), lightKeys_.begin(), lightKeys_.end(), sameKey);
  if (same) return {};
  restLights(scene);
  for (size_t i = 0; i < keys.size(); ++i) {
    const LightAnimation& a = scene.lightAnimations[i];
    for (PointLight& l : scene.pointLights)
      if (l.name == a.light) {
        if (a.movesPosition) l.position = keys[i].position;
        l.intensity *= a.scalesIntensity ? keys[i].factor : 1.0f;
      }
    for (SpotLight& l : scene.spotLights)
      if (l.name == a.light) {
        if (a.movesPosition) l.position = keys[i].position;
        if (a.turnsDirection) l.direction = keys[i].direction;
        l.intensity *= a.scalesIntensity ? keys[i].factor : 1.0f;
      }
    for (DirectionalLight& l : scene.directionalLights)
      if (l.name == a.light) {
        if (a.turnsDirection) l.direction = keys[i].direction;
        l.irradiance *= a.scalesIntensity ? keys[i].factor : 1.0f;
      }
  }
  lightKeys_ = std::move(keys);
  lightsStale_ = false;
  Changed changed;
  changed.lights = true;
  return changed;
}

}  // namespace hl
