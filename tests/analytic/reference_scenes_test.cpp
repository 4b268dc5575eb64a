// The reference's invariances and hard cases.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "tests/analytic/reference_fixture.h"

namespace hl {
namespace {

using namespace hl::test;

constexpr double kPiD = 3.14159265358979323846;

Scene litRoom(float scale = 1, vec3 move = vec3(0.0f)) {
  Scene s;
  std::vector<uint32_t> walls;
  for (const vec3& rho : {vec3(0.7f, 0.1f, 0.1f), vec3(0.1f, 0.6f, 0.1f), vec3(0.7f), vec3(0.7f), vec3(0.7f), vec3(0.3f)})
    walls.push_back(addMaterial(s, rho));
  const uint32_t light = addMaterial(s, vec3(0.5f), vec3(8), true);
  addRoom(s, move, move + scale * vec3(1, 0.8f, 1.2f), [&](int f) { return walls[static_cast<size_t>(f)]; });
  addQuad(s, move + scale * vec3(0.4f, 0.75f, 0.4f), scale * vec3(0.2f, 0, 0), scale * vec3(0, 0, 0.2f), light);
  addQuad(s, move + scale * vec3(0.2f, 0.3f, 0.5f), scale * vec3(0, 0, 0.3f), scale * vec3(0.4f, 0.1f, 0), addMaterial(s, vec3(0.6f), vec3(0.0f), true));
  return s;
}

std::vector<Receiver> floorOf(float scale = 1, vec3 move = vec3(0.0f)) {
  std::vector<Receiver> receivers;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      receivers.push_back(receiverAt(move + scale * vec3((static_cast<float>(i) + 0.5f) / 8, 0, 1.2f * (static_cast<float>(j) + 0.5f) / 8), vec3(0, 1, 0)));
  return receivers;
}

ReferenceSettings quick(int samples = 512) {
  ReferenceSettings s;
  s.samplesPerPixel = samples, s.directSamples = samples;
  return s;
}

struct Both {
  Estimate direct, indirect;
};
Both meanOfRun(const Scene& s, const std::vector<Receiver>& receivers, const ReferenceSettings& settings) {
  const auto r = trace(s, receivers, settings);
  EXPECT_EQ(r->nonFinite, 0u);
  return {meanOf(r->directImage(), false), meanOf(r->indirectImage(kAllBounces), false)};
}
void expectSame(const Both& a, const Both& b, const char* what) {
  const auto one = [&](const Estimate& x, const Estimate& y, const char* part) {
    const double error = std::hypot(x.error, y.error);
    EXPECT_LE(error, 0.01 * y.value) << what << ", " << part;
    EXPECT_NEAR(x.value, y.value, 3.5 * error) << what << ", " << part;
  };
  one(a.direct, b.direct, "direct");
  one(a.indirect, b.indirect, "indirect");
}

TEST(ReferenceScenes, TwiceTheLightIsTwiceTheResultToTheBit) {
  Scene s = litRoom();
  const auto once = trace(s, floorOf(), quick(64));
  for (Material& m : s.materials) m.emission *= 2.0f;
  const auto twice = trace(s, floorOf(), quick(64));
  const ReferenceImage a = once->indirectImage(kAllBounces), b = twice->indirectImage(kAllBounces);
  for (size_t i = 0; i < a.mean.data.size(); ++i) ASSERT_EQ(2 * a.mean.data[i], b.mean.data[i]);
}

TEST(ReferenceScenes, TwoLightsAreTheSum) {
  Scene area = litRoom(), lamp = litRoom(), both = litRoom();
  for (Material& m : lamp.materials) m.emission = vec3(0.0f);
  lamp.pointLights.push_back(pointLight(vec3(0.8f, 0.6f, 1), 0.3f));
  both.pointLights = lamp.pointLights;
  const Both a = meanOfRun(area, floorOf(), quick()), b = meanOfRun(lamp, floorOf(), quick()),
             sum = meanOfRun(both, floorOf(), quick());
  expectSame({{a.direct.value + b.direct.value, std::hypot(a.direct.error, b.direct.error)},
              {a.indirect.value + b.indirect.value, std::hypot(a.indirect.error, b.indirect.error)}},
             sum, "sum of lights");
}

TEST(ReferenceScenes, RotatedAndMirrored) {
  const Scene s = litRoom();
  const std::vector<Receiver> receivers = floorOf();
  const Both plain = meanOfRun(s, receivers, quick());
  const auto transformed = [&](const mat3& m, bool mirrored) {
    Scene t = s;
    std::vector<Receiver> r = receivers;
    t.bounds = {};
    for (vec3& p : t.positions) p = m * p, t.bounds.extend(p);
    for (vec3& n : t.normals) n = m * n;
    if (mirrored)
      for (uvec3& i : t.indices) std::swap(i.y, i.z);
    for (Receiver& x : r) x.position = m * x.position, x.geometricNormal = x.mappedNormal = m * x.geometricNormal;
    return meanOfRun(t, r, quick());
  };
  const vec3 x = glm::normalize(vec3(2, -1, 0.5f)), y = glm::normalize(glm::cross(vec3(0.3f, 0.2f, 1), x));
  expectSame(transformed(mat3(x, y, glm::cross(x, y)), false), plain, "rotated");
  expectSame(transformed(mat3(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)), true), plain, "mirrored");
}

TEST(ReferenceScenes, ScaledAndMoved) {
  const Both plain = meanOfRun(litRoom(), floorOf(), quick());
  expectSame(meanOfRun(litRoom(1e-3f), floorOf(1e-3f), quick()), plain, "a thousandth");
  expectSame(meanOfRun(litRoom(1e3f), floorOf(1e3f), quick()), plain, "a thousand times");
  // As far from the origin as import leaves a scene.
  const vec3 far(40, -30, 20);
  expectSame(meanOfRun(litRoom(1, far), floorOf(1, far), quick()), plain, "moved");
}

// A light of a thousandth of the ceiling's area, against the same flux from a point of cosine emission: no firefly may carry the mean.
TEST(ReferenceScenes, SmallEmitter) {
  Scene s;
  addRoom(s, vec3(0.0f), vec3(2.0f), addMaterial(s, vec3(0.5f)));
  constexpr float kSide = 0.02f;
  addQuad(s, vec3(1 - kSide / 2, 1.9f, 1 - kSide / 2), vec3(kSide, 0, 0), vec3(0, 0, kSide), addMaterial(s, vec3(0.5f), vec3(1e4f), true));
  const auto r = trace(s, receiversOverSurface(s, 1024), quick(128));
  const double flux = kPiD * 1e4 * static_cast<double>(kSide) * static_cast<double>(kSide);
  const double truth = 0.5 * flux / (surfaceArea(s) * 0.5);
  const Estimate e = meanOf(r->indirectImage(kAllBounces), false);
  EXPECT_LE(e.error, 5e-3 * truth);
  EXPECT_NEAR(e.value, truth, 3 * e.error + 5e-3 * truth);
}

TEST(ReferenceScenes, SkyOverAPlane) {
  Scene s;
  addQuad(s, vec3(-50, 0, -50), vec3(0, 0, 100), vec3(100, 0, 0), addMaterial(s, vec3(0.5f)));
  s.sky = vec3(2);
  const std::vector<Receiver> receivers = {receiverAt(vec3(0.0f), vec3(0, 1, 0)),
                                           receiverAt(vec3(0, 1e-3f, 0), vec3(1, 0, 0))};
  const auto r = trace(s, receivers, quick(4096));
  const ReferenceImage direct = r->directImage(), indirect = r->indirectImage(kAllBounces);
  EXPECT_NEAR(direct.mean.data[0], 2 * kPiD, 1e-4) << "an open plane sees nothing but sky";
  EXPECT_EQ(indirect.mean.data[0], 0);
  // A vertical element on the ground: half sky, half ground of radiance rho E / pi = 1.
  EXPECT_NEAR(direct.mean.data[3], kPiD, 0.01);
  EXPECT_NEAR(indirect.mean.data[3], 0.5 * kPiD, 0.01);
}

// Under a sky a thousand times as bright as the light inside, a closed room must not tell.
TEST(ReferenceScenes, ClosedRoomDoesNotLeak) {
  Scene s = litRoom();
  const auto before = meanOfRun(s, receiversOverSurface(s, 512), quick(128));
  for (Material& m : s.materials) m.emission = vec3(0.0f);
  s.sky = vec3(1e3f);
  const auto r = trace(s, receiversOverSurface(s, 512), quick(128));
  const Estimate leak = meanOf(r->indirectImage(kAllBounces), false), direct = meanOf(r->directImage(), false);
  EXPECT_LT(leak.value, 1e-4 * 1e3) << "of the sky";
  EXPECT_LT(direct.value, 1e-4 * 1e3);
  EXPECT_GT(before.indirect.value, 0.1);
}

TEST(ReferenceScenes, BackFacesAbsorbAndAreCounted) {
  Scene s = litRoom();
  ReferenceSettings settings = quick(128);
  EXPECT_EQ(trace(s, floorOf(), settings)->backFaceHits, 0u) << "the two-sided panel reflects on both sides";
  const Both twoSided = meanOfRun(s, floorOf(), settings);
  settings.frontFacesOnly = true;
  const auto frontOnly = trace(s, floorOf(), settings);
  EXPECT_GT(frontOnly->backFaceHits, 0u);
  for (Material& m : s.materials) m.twoSided = false;
  settings.frontFacesOnly = false;
  const auto oneSided = trace(s, floorOf(), settings);
  EXPECT_EQ(oneSided->backFaceHits, frontOnly->backFaceHits);
  EXPECT_LT(meanOf(oneSided->indirectImage(kAllBounces), false).value, twoSided.indirect.value);
  std::vector<Receiver> back = floorOf();
  for (Receiver& r : back) r.backFace = true;
  const auto none = trace(s, back, settings);
  EXPECT_EQ(meanOf(none->directImage(), false).value, 0);
  for (Receiver& r : back) r.twoSided = true;
  EXPECT_GT(meanOf(trace(s, back, settings)->directImage(), false).value, 0);
  settings.frontFacesOnly = true;
  EXPECT_EQ(meanOf(trace(s, back, settings)->directImage(), false).value, 0);
}

// A leaf half of whose texture is cut away casts half its shadow, and reflects with half of itself.
TEST(ReferenceScenes, AlphaTestedLeaf) {
  const auto direct = [](bool leaf, bool cut) {
    Scene s;
    addQuad(s, vec3(-1, 0, -1), vec3(0, 0, 2), vec3(2, 0, 0), addMaterial(s, vec3(0.5f)));
    s.pointLights.push_back(pointLight(vec3(0, 2, 0), 10));
    if (leaf) {
      Texture t;
      t.width = 64, t.height = 1, t.rgba.assign(256, 255);
      if (cut)
        for (size_t x = 0; x < 32; ++x) t.rgba[4 * x + 3] = 0;
      s.textures.push_back(t);
      const uint32_t m = addMaterial(s, vec3(0.5f), vec3(0.0f), true);
      s.materials[m].albedoTexture = 0, s.materials[m].alphaCutoff = 0.5f;
      addQuad(s, vec3(-0.25f, 1, 0.25f), vec3(0.5f, 0, 0), vec3(0, 0, -0.5f), m);
    }
    std::vector<Receiver> receivers;  // under the leaf's shadow [-0.5, 0.5]^2: first its left half
    for (int i = 0; i < 16; ++i)
      receivers.push_back(receiverAt(vec3(-0.469f + static_cast<float>(i) / 16, 0, 0.03f), vec3(0, 1, 0)));
    const auto r = trace(s, receivers, quick(1024));
    const ReferenceImage d = r->directImage(), e = r->indirectImage(kAllBounces);
    return std::array<double, 3>{meanOf(d, 0, 8, false).value, meanOf(d, 8, 16, false).value, meanOf(e, 0, 16, false).value};
  };
  const auto open = direct(false, false), whole = direct(true, false), half = direct(true, true);
  EXPECT_EQ(whole[0], 0);
  EXPECT_EQ(whole[1], 0);
  EXPECT_NEAR(half[0], open[0], 1e-4 * open[0]);
  EXPECT_EQ(half[1], 0);
  EXPECT_GT(half[2], 0) << "lit ground, seen again in the leaf's underside";
}

// Faces that are there twice, or have no area, change nothing.
TEST(ReferenceScenes, DoubledAndEmptyTriangles) {
  const Scene s = litRoom();
  Scene doubled = s;
  for (size_t t = 0; t < s.indices.size(); ++t) {
    const uvec3 i = s.indices[t];
    doubled.indices.push_back(uvec3(i.y, i.z, i.x));
    doubled.indices.push_back(uvec3(i.x, i.x, i.y));
    for (int k = 0; k < 2; ++k) doubled.materialIds.push_back(s.materialIds[t]), doubled.objectIds.push_back(0);
  }
  expectSame(meanOfRun(doubled, floorOf(), quick()), meanOfRun(s, floorOf(), quick()), "doubled");
}

TEST(ReferenceScenes, InfiniteAndBrightEmitters) {
  Scene s = litRoom();
  const Both plain = meanOfRun(s, floorOf(), quick(128));
  const uint32_t inf = addMaterial(s, vec3(0.5f), vec3(std::numeric_limits<float>::infinity()));
  addQuad(s, vec3(0.1f, 0.79f, 1.0f), vec3(0.01f, 0, 0), vec3(0, 0, 0.01f), inf);
  const auto r = trace(s, floorOf(), quick(1024));
  EXPECT_GT(r->nonFinite, 0u);
  const Estimate e = meanOf(r->indirectImage(kAllBounces), false);
  EXPECT_TRUE(std::isfinite(e.value));
  EXPECT_NEAR(e.value, plain.indirect.value, 0.05 * plain.indirect.value);
  // 1e5 times as bright as the rest, and yet the rest is there.
  Scene bright = litRoom();
  addQuad(bright, vec3(0.1f, 0.79f, 1.0f), vec3(0.01f, 0, 0), vec3(0, 0, 0.01f), addMaterial(bright, vec3(0.5f), vec3(8e5f)));
  const Both b = meanOfRun(bright, floorOf(), quick(512));
  EXPECT_GT(b.direct.value, plain.direct.value);
  EXPECT_LE(b.indirect.error, 0.03 * b.indirect.value);
}

TEST(ReferenceScenes, NothingThere) {
  Scene empty;
  empty.sky = vec3(1);
  const auto r = trace(empty, {receiverAt(vec3(0.0f), vec3(0, 1, 0)), Receiver{}}, quick(64));
  EXPECT_NEAR(r->directImage().mean.data[0], kPiD, 1e-4);
  EXPECT_EQ(r->directImage().mean.data[3], 0) << "no surface, no light";
  EXPECT_EQ(r->indirectImage(kAllBounces).mean.data[0], 0);
  Scene one;
  addTriangle(one, vec3(0, 0, 0), vec3(0, 0, 1), vec3(1, 0, 0), addMaterial(one, vec3(0.5f)), vec3(0, 1, 0), vec3(0, 1, 0), vec3(0, 1, 0));
  EXPECT_EQ(trace(one, {receiverAt(vec3(0.2f, 0, 0.2f), vec3(0, 1, 0))}, quick(64))->indirectImage(1).mean.data[0], 0);
}

// Light from below the surface does not arrive, whatever the mapped normal says; what does is weighed with the mapped normal.
TEST(ReferenceScenes, MappedReceiver) {
  Scene s;
  s.sky = vec3(1);
  addQuad(s, vec3(-50, 0, -50), vec3(0, 0, 100), vec3(100, 0, 0), addMaterial(s, vec3(0.0f)));
  Receiver r = receiverAt(vec3(0.0f), vec3(0, 1, 0));
  r.mappedNormal = glm::normalize(vec3(1, 1, 0));
  ReferenceSettings settings = quick(4096);
  // pi (1 + cos 45) / 2 of the upper hemisphere reaches a plane tilted by 45 degrees.
  EXPECT_NEAR(static_cast<double>(trace(s, {r}, settings)->directImage().mean.data[0]), kPiD * (1 + std::sqrt(0.5)) / 2, 0.01);
  settings.receiver = ReceiverNormal::Geometric;
  EXPECT_NEAR(static_cast<double>(trace(s, {r}, settings)->directImage().mean.data[0]), kPiD, 1e-3);
}

TEST(ReferenceScenes, WrongReceiverCountIsRefused) {
  const Scene s = litRoom();
  EXPECT_THROW(ReferenceTracer(std::make_shared<EmbreeScene>(s), floorOf(), 7, 7, quick(), sharedPool()), Error);
}

}  // namespace
}  // namespace hl
