// What the reference makes of a hit: sides, smooth and mapped normals, albedo.
#include "engine/reference/surface.h"

#include <gtest/gtest.h>

#include "tests/analytic/reference_fixture.h"

namespace hl {
namespace {

using namespace hl::test;

/// A unit square in the xz plane, its front up, u along +z, v along +x; one texel of normal map that tilts by (0.6, 0, 0.8).
Scene square() {
  Scene s;
  const uint32_t m = addMaterial(s, vec3(2, 0.5f, 0.25f));
  Texture tilt;
  tilt.width = tilt.height = 1, tilt.srgb = false, tilt.rgba = {204, 128, 230, 255};
  s.textures.push_back(tilt);
  addQuad(s, vec3(0.0f), vec3(0, 0, 1), vec3(1, 0, 0), m);
  return s;
}

Surface at(const Scene& s, vec3 direction, bool mapped, uint32_t triangle = 0) {
  return surfaceAt(s, shared::Hit{1, triangle, 0.25f, 0.5f}, direction, mapped);
}

TEST(ReferenceSurface, SidesAndAlbedo) {
  const Scene s = square();
  const Surface front = at(s, vec3(0, -1, 0), true), back = at(s, vec3(0, 1, 0), true);
  EXPECT_FALSE(front.backFace);
  EXPECT_TRUE(back.backFace);
  EXPECT_EQ(front.geometricNormal, vec3(0, 1, 0));
  EXPECT_EQ(back.geometricNormal, vec3(0, -1, 0));
  EXPECT_EQ(back.normal, vec3(0, -1, 0));
  EXPECT_LT(glm::length(front.position - vec3(0.5f, 0, 0.75f)), 1e-6f);
  EXPECT_EQ(front.albedo, vec3(kMaxAlbedo, 0.5f, 0.25f)) << "capped";
}

TEST(ReferenceSurface, NormalMapTiltsAlongU) {
  Scene s = square();
  s.materials[0].normalTexture = 0;
  for (const uint32_t triangle : {0u, 1u}) {
    EXPECT_LT(glm::length(at(s, vec3(0, -1, 0), true, triangle).normal - vec3(0, 0.8f, 0.6f)), 0.01f) << triangle;
    EXPECT_EQ(at(s, vec3(0, -1, 0), false, triangle).normal, vec3(0, 1, 0)) << triangle;
    EXPECT_LT(glm::length(at(s, vec3(0, 1, 0), true, triangle).normal - vec3(0, -0.8f, -0.6f)), 0.01f) << "seen from behind";
  }
  for (vec2& uv : s.uvs) uv.x = -uv.x;  // mirrored: u runs along -z
  EXPECT_LT(glm::length(at(s, vec3(0, -1, 0), true).normal - vec3(0, 0.8f, -0.6f)), 0.01f);
  for (vec2& uv : s.uvs) uv = vec2(0.5f);  // no direction of u: the map says nothing
  EXPECT_EQ(at(s, vec3(0, -1, 0), true).normal, vec3(0, 1, 0));
}

TEST(ReferenceSurface, SmoothNormals) {
  Scene s = square();
  for (vec3& n : s.normals) n = glm::normalize(vec3(1, 1, 0));
  EXPECT_LT(glm::length(at(s, vec3(0, -1, 0), true).normal - glm::normalize(vec3(1, 1, 0))), 1e-6f);
  EXPECT_EQ(at(s, vec3(0, -1, 0), false).normal, vec3(0, 1, 0));
  for (vec3& n : s.normals) n = -n;  // to the back: turned
  EXPECT_LT(glm::length(at(s, vec3(0, -1, 0), true).normal - glm::normalize(vec3(1, 1, 0))), 1e-6f);
  for (vec3& n : s.normals) n = vec3(0.0f);
  EXPECT_EQ(at(s, vec3(0, -1, 0), true).normal, vec3(0, 1, 0));
}

}  // namespace
}  // namespace hl
