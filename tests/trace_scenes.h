#pragma once
// Small scenes made in code, for the tests of rays and of direct light.
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/scene/scene.h"
#include "shaders/shared/random.h"

namespace hl::test {

inline uint32_t addMaterial(Scene& scene, vec3 emission = vec3(0.0f)) {
  Material m;
  m.name = "material " + std::to_string(scene.materials.size());
  m.emission = emission;
  scene.materials.push_back(m);
  return static_cast<uint32_t>(scene.materials.size() - 1);
}

inline void addTriangle(Scene& scene, vec3 a, vec3 b, vec3 c, uint32_t material) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  const vec3 n = glm::cross(b - a, c - a);
  const float length = glm::length(n);
  const vec3 uvs[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  int k = 0;
  for (const vec3 p : {a, b, c}) {
    scene.positions.push_back(p);
    scene.normals.push_back(length > 0 ? n / length : vec3(0, 1, 0));
    scene.uvs.emplace_back(uvs[k].x, uvs[k].y);
    scene.bounds.extend(p);
    ++k;
  }
  scene.indices.emplace_back(first, first + 1, first + 2);
  scene.materialIds.push_back(material);
  scene.objectIds.push_back(0);
  if (scene.objects.empty()) scene.objects.emplace_back("object");
}

/// Corner p, edges a and b; the front is where cross(a, b) points. UVs run along a and b.
inline void addQuad(Scene& scene, vec3 p, vec3 a, vec3 b, uint32_t material) {
  addTriangle(scene, p, p + a, p + a + b, material);
  const size_t n = scene.uvs.size();
  scene.uvs[n - 2] = vec2(1, 0), scene.uvs[n - 1] = vec2(1, 1);
  addTriangle(scene, p, p + a + b, p + b, material);
  const size_t m = scene.uvs.size();
  scene.uvs[m - 2] = vec2(1, 1), scene.uvs[m - 1] = vec2(0, 1);
}

/// All six faces of [low, high]^3, their fronts inside.
inline void addRoom(Scene& scene, float low, float high, uint32_t material) {
  const float s = high - low;
  const vec3 lo(low), hi(high), x(s, 0, 0), y(0, s, 0), z(0, 0, s);
  addQuad(scene, lo, x, y, material), addQuad(scene, lo, y, z, material), addQuad(scene, lo, z, x, material);
  addQuad(scene, hi, -y, -x, material), addQuad(scene, hi, -z, -y, material), addQuad(scene, hi, -x, -z, material);
}

/// A room with tilted boxes and slivers in it: what a Cornell box asks of a tracer, without its file.
inline Scene furnishedRoom(float scale = 1) {
  Scene scene;
  const uint32_t grey = addMaterial(scene);
  addRoom(scene, 0, 1, grey);
  shared::Random r = shared::randomInit(7, 0, 0);
  const auto random = [&] { return shared::randomFloat(r); };
  for (int i = 0; i < 60; ++i) {
    const vec3 p(random(), random(), random());
    const vec3 a = 0.3f * vec3(random() - 0.5f, random() - 0.5f, random() - 0.5f);
    const vec3 b = (i % 4 == 0 ? 1e-4f : 0.3f) * vec3(random() - 0.5f, random() - 0.5f, random() - 0.5f);
    addQuad(scene, p, a, b, grey);
  }
  scene.bounds = {};
  for (vec3& p : scene.positions) scene.bounds.extend(p *= scale);
  return scene;
}

/// Leaves: quads whose texture is opaque inside a circle, in front of a wall.
inline Scene foliage() {
  Scene scene;
  const uint32_t wall = addMaterial(scene), leaf = addMaterial(scene);
  Texture texture;
  texture.name = "leaf";
  texture.width = 32, texture.height = 16;
  for (int y = 0; y < texture.height; ++y)
    for (int x = 0; x < texture.width; ++x) {
      const float dx = (static_cast<float>(x) + 0.5f) / 32 - 0.5f, dy = (static_cast<float>(y) + 0.5f) / 16 - 0.5f;
      const uint8_t alpha = dx * dx + dy * dy < 0.16f ? 255 : 0;
      for (const uint8_t value : {uint8_t{60}, uint8_t{160}, uint8_t{40}, alpha}) texture.rgba.push_back(value);
    }
  Texture larger;  // gives the layers another size than the leaf's
  larger.name = "bark";
  larger.width = 48, larger.height = 48;
  larger.rgba.assign(48 * 48 * 4, 200);
  scene.textures = {larger, texture};
  scene.hasUvs = true;
  scene.materials[leaf].albedoTexture = 1;
  scene.materials[leaf].alphaCutoff = 0.5f;
  addQuad(scene, vec3(-2, -2, -1), vec3(4, 0, 0), vec3(0, 4, 0), wall);
  shared::Random r = shared::randomInit(3, 1, 4);
  const auto random = [&] { return shared::randomFloat(r) * 2 - 1; };
  for (int i = 0; i < 400; ++i)
    addQuad(scene, vec3(random(), random(), random() * 0.5f), 0.3f * vec3(random(), random(), random()),
            0.3f * vec3(random(), random(), random()), leaf);
  return scene;
}

}  // namespace hl::test
