#pragma once
// Scenes with moving objects, made in code.
#include "engine/scene/scene_build.h"
#include "tests/trace_scenes.h"

namespace hl::test {

/// Makes the triangles from `first` on an object of their own.
inline uint32_t addObject(Scene& scene, const std::string& name, size_t first) {
  scene.objects.push_back(name);
  const auto id = static_cast<uint32_t>(scene.objects.size() - 1);
  for (size_t t = first; t < scene.objectIds.size(); ++t) scene.objectIds[t] = id;
  return id;
}

/// furnishedRoom() with its second half of slivers turning about a tilted axis, and one quad of them sliding and growing.
inline Scene turningRoom() {
  Scene scene = furnishedRoom();
  const uint32_t slivers = addObject(scene, "slivers", scene.indices.size() / 2);
  const uint32_t sheet = addObject(scene, "sheet", scene.indices.size() - 2);
  ObjectAnimation turn;
  turn.name = "turn", turn.objects = {slivers, sheet}, turn.pivot = vec3(0.5f, 0.4f, 0.5f), turn.axis = glm::normalize(vec3(1, 2, 3));
  turn.keys = {{0, vec3(0), 0, vec3(1)}, {2, vec3(0), 2 * kPi, vec3(1)}};
  ObjectAnimation slide;
  slide.name = "slide", slide.objects = {sheet}, slide.pivot = vec3(0.5f), slide.repeat = Repeat::PingPong, slide.eased = true;
  slide.keys = {{0, vec3(0), 0, vec3(1)}, {1, vec3(0.2f, 0.1f, -0.1f), 0, vec3(1.5f, 1, 0.5f)}};
  scene.animations = {turn, slide};
  finishScene(scene);
  return scene;
}

/// foliage() with half of the leaves blown about.
inline Scene windyFoliage() {
  Scene scene = foliage();
  const uint32_t leaves = addObject(scene, "leaves", scene.indices.size() / 2);
  ObjectAnimation blow;
  blow.name = "blow", blow.objects = {leaves}, blow.axis = vec3(0, 0, 1), blow.repeat = Repeat::PingPong;
  blow.keys = {{0, vec3(0), 0, vec3(1)}, {1, vec3(0.3f, -0.1f, 0.2f), 1, vec3(1)}};
  scene.animations = {blow};
  finishScene(scene);
  return scene;
}

}  // namespace hl::test
