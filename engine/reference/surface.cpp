#include "engine/reference/surface.h"

#include <cmath>

#include "engine/scene/texture_sampling.h"

namespace hl {
namespace {

constexpr float kLeastSmoothNormal2 = 1e-12f;  // as in shaders/scene.glsl

struct Corners {
  uvec3 i;
  vec3 e1, e2;  ///< edges from corner 0
};

/// The smooth normal tilted by the normal map, whose x and y run along u and v on the surface.
vec3 tilted(const Scene& scene, const Material& m, const shared::Hit& hit, const Corners& c, vec3 smooth) {
  const vec2 d1 = scene.uvs[c.i.y] - scene.uvs[c.i.x], d2 = scene.uvs[c.i.z] - scene.uvs[c.i.x];
  const float det = d1.x * d2.y - d2.x * d1.y;
  if (det == 0) return smooth;
  const float sign = det < 0 ? -1.0f : 1.0f;
  const vec3 alongU = (c.e1 * d2.y - c.e2 * d1.y) * sign, alongV = (c.e2 * d1.x - c.e1 * d2.x) * sign;
  const vec3 flat = alongU - smooth * glm::dot(smooth, alongU);
  if (!(glm::dot(flat, flat) > 0)) return smooth;
  const vec3 tangent = glm::normalize(flat);
  vec3 bitangent = glm::cross(smooth, tangent);
  if (glm::dot(bitangent, alongV) < 0) bitangent = -bitangent;
  const vec4 texel = sampleTexture(scene.textures[m.normalTexture], uvAt(scene, hit.primitive, hit.u, hit.v));
  const vec3 n = tangent * (2 * texel.x - 1) + bitangent * (2 * texel.y - 1) + smooth * (2 * texel.z - 1);
  return glm::dot(n, n) > 0 ? glm::normalize(n) : smooth;
}

}  // namespace

Surface surfaceAt(const Scene& scene, const shared::Hit& hit, vec3 direction, bool mappedNormals) {
  const Material& m = scene.materials[scene.materialIds[hit.primitive]];
  Corners c;
  c.i = scene.indices[hit.primitive];
  const vec3 p0 = scene.positions[c.i.x];
  c.e1 = scene.positions[c.i.y] - p0, c.e2 = scene.positions[c.i.z] - p0;
  Surface s;
  s.position = p0 + c.e1 * hit.u + c.e2 * hit.v;
  s.geometricNormal = glm::normalize(glm::cross(c.e1, c.e2));
  s.backFace = glm::dot(s.geometricNormal, direction) > 0;
  s.twoSided = m.twoSided;
  s.albedo = m.albedoTexture == kNone ? glm::min(m.albedo, vec3(kMaxAlbedo))
                                      : albedoAt(scene, m, uvAt(scene, hit.primitive, hit.u, hit.v));
  s.normal = s.geometricNormal;
  if (mappedNormals) {
    const vec3 smooth = (1 - hit.u - hit.v) * scene.normals[c.i.x] + hit.u * scene.normals[c.i.y] +
                        hit.v * scene.normals[c.i.z];
    // As the rasteriser has it: vertex normals that cancel out say nothing, those that point to the back are turned.
    if (glm::dot(smooth, smooth) >= kLeastSmoothNormal2)
      s.normal = glm::normalize(glm::dot(smooth, s.geometricNormal) < 0 ? -smooth : smooth);
    if (m.normalTexture != kNone) s.normal = tilted(scene, m, hit, c, s.normal);
  }
  if (s.backFace) s.geometricNormal = -s.geometricNormal, s.normal = -s.normal;
  return s;
}

}  // namespace hl
