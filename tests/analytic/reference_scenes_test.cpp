// The reference where the answer is known: enclosures, form factors by rays, invariances, hard cases.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "tests/analytic/reference_fixture.h"

namespace hl {
namespace {

using namespace hl::test;

constexpr double kPiD = 3.14159265358979323846;

PointLight pointLight(vec3 position, float candela) {
  PointLight l;
  l.position = position, l.intensity = vec3(candela);
  return l;
}

// MEASURES.md section 1: 10 m, 50 000 cd in the centre, rho = 2/3, luminance rho / pi (direct + indirect).
TEST(ReferenceScenes, PointLightCube) {
  Scene s;
  addRoom(s, vec3(-5.0f), vec3(5.0f), addMaterial(s, vec3(2.0f / 3)));
  s.pointLights.push_back(pointLight(vec3(0.0f), 50000));
  struct Point {
    float x, y;
    double luminance, indirect;
  };
  const std::vector<Point> points = {{0, 0, 892.83, 468.4},   {0, 0.5f, 768.68, 465.0}, {0.5f, 0.5f, 686.67, 455.7},
                                     {0, 1, 565.11, 0},       {0.5f, 1, 522.42, 0},     {1, 1, 388.40, 0}};
  // The edges' values are limits. Towards an edge of a diffuse 90 degree corner light falls as distance^0.7 at this albedo
  // (rho / 4 B(1 + a/2, (1 - a)/2) = 1): at half a millimetre it is still 0.1 % to 0.2 % up.
  constexpr float kFromEdge = 5e-4f;
  // Each point on all six faces by symmetry: 6 receivers a point.
  std::vector<Receiver> receivers;
  for (const Point& p : points)
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      const float side = face % 2 ? 1.0f : -1.0f;
      vec3 at, n(0.0f);
      at[axis] = 5 * side, n[axis] = -side;
      at[(axis + 1) % 3] = std::min(5 * p.x, 5 - kFromEdge) * side;
      at[(axis + 2) % 3] = std::min(5 * p.y, 5 - kFromEdge) * -side;
      receivers.push_back(receiverAt(at, n));
    }
  ReferenceSettings settings;
  settings.samplesPerPixel = 1 << 14;
  const auto r = trace(s, receivers, settings);
  EXPECT_EQ(r->nonFinite, 0u);
  // A hit within rounding of an edge can lie beyond the wall there.
  EXPECT_LT(static_cast<double>(r->backFaceHits), 1e-4 * static_cast<double>(r->paths));
  const ReferenceImage direct = r->directImage(), indirect = r->indirectImage(kAllBounces);
  const double k = 2.0 / 3 / kPiD;
  for (size_t i = 0; i < points.size(); ++i) {
    const Estimate d = meanOf(direct, 6 * i, 6 * i + 6, true), e = meanOf(indirect, 6 * i, 6 * i + 6, true);
    std::printf("(%.1f, %.1f): luminance %.2f of %.2f, standard error %.2f\n", static_cast<double>(points[i].x),
                static_cast<double>(points[i].y), k * (d.value + e.value), points[i].luminance, k * e.error);
    const double limit = points[i].indirect > 0 ? 0 : 3e-3;
    EXPECT_LE(k * e.error, 1.5e-3 * points[i].luminance);
    EXPECT_NEAR(k * (d.value + e.value), points[i].luminance, 3 * k * e.error + 0.05 + limit * points[i].luminance);
    if (points[i].indirect > 0) {
      EXPECT_NEAR(k * e.value, points[i].indirect, 3 * k * e.error + 0.05);
    }
  }
  // And the mean over the surface: rho Phi / (A (1 - rho)) / pi of it with direct light, exactly 666.667.
  const std::vector<Receiver> all = receiversOverSurface(s, 3072);
  settings.samplesPerPixel = 128;
  const Estimate mean = meanOf(trace(s, all, settings)->indirectImage(kAllBounces), false);
  const double truth = 2.0 / 3 * 4 * kPiD * 50000 / (600 * (1 - 2.0 / 3));
  EXPECT_LE(mean.error, 1e-3 * truth);
  EXPECT_NEAR(mean.value, truth, 3 * mean.error + 5e-4 * truth);  // the second: 3072 points stand for the surface
}

// Any source of flux Phi in a sphere: the indirect irradiance is rho Phi / (A (1 - rho)) everywhere.
TEST(ReferenceScenes, SphereIsUniform) {
  Scene s;
  addSphereFromInside(s, 2, 96, addMaterial(s, vec3(0.8f)));
  s.pointLights.push_back(pointLight(vec3(0.9f, 0.4f, -0.6f), 100));
  std::vector<Receiver> receivers;
  for (size_t t = 0; t < s.indices.size(); t += 149) {
    const uvec3 i = s.indices[t];
    const vec3 a = s.positions[i.x], b = s.positions[i.y], c = s.positions[i.z];
    receivers.push_back(receiverAt((a + b + c) / 3.0f, glm::normalize(glm::cross(b - a, c - a))));
  }
  ReferenceSettings settings;
  settings.samplesPerPixel = 1024;
  settings.receiver = ReceiverNormal::Geometric;
  const auto r = trace(s, receivers, settings);
  const ReferenceImage indirect = r->indirectImage(kAllBounces);
  const double truth = 0.8 * 4 * kPiD * 100 / (surfaceArea(s) * 0.2);
  // A facetted sphere of 96 rows is off by its sagitta, (pi / 96)^2 / 8 = 1.3e-4.
  const Estimate mean = meanOf(indirect, true);
  EXPECT_LE(mean.error, 1e-3 * truth);
  EXPECT_NEAR(mean.value, truth, 3 * mean.error + 3e-4 * truth);
  // Off centre as it is, the direct light differs several times over; the indirect light of no receiver stands out.
  double most = 0;
  for (size_t p = 0; p < receivers.size(); ++p) {
    const Estimate e = meanOf(indirect, p, p + 1, false);
    most = std::max(most, std::abs(e.value - truth) / truth);
  }
  EXPECT_LT(most, 0.06) << "over " << receivers.size() << " receivers";
  const ReferenceImage direct = r->directImage();
  const auto [low, high] = std::minmax_element(direct.mean.data.begin(), direct.mean.data.end());
  EXPECT_GT(*high, 3 * *low);
}

// 4 m cube with 10 000 lm in it: mean indirect irradiance by albedo.
TEST(ReferenceScenes, CubeByAlbedo) {
  for (const auto& [rho, truth] : {std::pair{0.0f, 0.0}, {0.2f, 26.04}, {0.5f, 104.17}, {0.8f, 416.67}, {0.9f, 937.5}, {0.99f, 10312.5}}) {
    Scene s;
    addRoom(s, vec3(-2.0f), vec3(2.0f), addMaterial(s, vec3(rho)));
    s.pointLights.push_back(pointLight(vec3(0.5f, -0.3f, 0.2f), static_cast<float>(10000 / (4 * kPiD))));
    ReferenceSettings settings;
    settings.samplesPerPixel = 64;
    const auto r = trace(s, receiversOverSurface(s, 1536), settings);
    EXPECT_EQ(r->nonFinite, 0u);
    const Estimate e = meanOf(r->indirectImage(kAllBounces), false);
    if (rho == 0) {
      EXPECT_EQ(e.value, 0);
      continue;
    }
    const double precision = rho > 0.95f ? 0.02 : 3e-3;
    EXPECT_LE(e.error, precision * truth) << rho;
    EXPECT_NEAR(e.value, truth, 3 * e.error + 2e-3 * truth) << rho << ", standard error " << e.error;
  }
}

// What the surfaces absorb is what the light emits, with walls that differ, a box inside and a ceiling that shines.
TEST(ReferenceScenes, AbsorbedEqualsEmitted) {
  Scene s;
  std::vector<uint32_t> walls;
  for (const float rho : {0.7f, 0.5f, 0.2f, 0.3f, 0.6f, 0.4f}) walls.push_back(addMaterial(s, vec3(rho)));
  s.materials[3].emission = vec3(5);  // the ceiling, 3 m by 4 m
  addRoom(s, vec3(0.0f), vec3(3, 2, 4), [&](int face) { return walls[static_cast<size_t>(face)]; });
  Scene box;
  addRoom(box, vec3(0.7f, 0.4f, 1.1f), vec3(1.9f, 1.2f, 2.3f), 0u);
  for (const uvec3& i : box.indices)  // turned inside out
    addTriangle(s, box.positions[i.x], box.positions[i.z], box.positions[i.y], walls[0], -box.normals[i.x], -box.normals[i.z],
                -box.normals[i.y]);
  const std::vector<Receiver> receivers = receiversOverSurface(s, 2048);
  ReferenceSettings settings;
  settings.samplesPerPixel = 128, settings.directSamples = 128;
  const auto r = trace(s, receivers, settings);
  EXPECT_LT(static_cast<double>(r->backFaceHits), 1e-4 * static_cast<double>(r->paths));
  // Of every receiver the share of its triangle's material; receivers lie in the triangles' order and in proportion to area.
  const ReferenceImage direct = r->directImage(), indirect = r->indirectImage(kAllBounces);
  std::vector<double> share[2];
  double area = 0, absorbed = 0, variance = 0;
  std::vector<double> upTo;
  for (const uvec3& t : s.indices)
    upTo.push_back(area += 0.5 * static_cast<double>(glm::length(
                                     glm::cross(s.positions[t.y] - s.positions[t.x], s.positions[t.z] - s.positions[t.x]))));
  const double each = area / static_cast<double>(receivers.size());
  size_t t = 0;
  for (size_t i = 0; i < receivers.size(); ++i) {
    while (upTo[t] < (static_cast<double>(i) + 0.5) * each && t + 1 < upTo.size()) ++t;
    const double loss = each * (1 - static_cast<double>(s.materials[s.materialIds[t]].albedo.x));
    absorbed += loss * static_cast<double>(direct.mean.data[3 * i] + indirect.mean.data[3 * i]);
    const double a = static_cast<double>(direct.halfA.data[3 * i] + indirect.halfA.data[3 * i]);
    const double b = static_cast<double>(direct.halfB.data[3 * i] + indirect.halfB.data[3 * i]);
    variance += loss * loss * (a - b) * (a - b) / 4;
  }
  const double emitted = kPiD * 5 * 12;
  EXPECT_LE(std::sqrt(variance), 2e-3 * emitted);
  EXPECT_NEAR(absorbed, emitted, 3 * std::sqrt(variance) + 3e-3 * emitted) << "standard error " << std::sqrt(variance);
}

/// Form factor from a square to an emitting one by the reference's direct light.
Estimate byRays(const std::function<void(Scene&, uint32_t emitter)>& build, vec3 corner, vec3 e1, vec3 e2) {
  Scene s;
  const uint32_t emitter = addMaterial(s, vec3(0.0f), vec3(1)), black = addMaterial(s, vec3(0.0f), vec3(0.0f), true);
  addQuad(s, corner, e1, e2, black);
  build(s, emitter);
  constexpr int kSide = 40;
  std::vector<Receiver> receivers;
  const vec3 n = glm::normalize(glm::cross(e1, e2));
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i)
      receivers.push_back(receiverAt(corner + e1 * ((static_cast<float>(i) + 0.5f) / kSide) + e2 * ((static_cast<float>(j) + 0.5f) / kSide), n));
  ReferenceSettings settings;
  settings.samplesPerPixel = 2, settings.maxBounces = 0, settings.directSamples = 256;
  Estimate e = meanOf(trace(s, receivers, settings)->directImage(), false);
  e.value /= kPiD, e.error /= kPiD;
  return e;
}

TEST(ReferenceScenes, FormFactorsByRays) {
  const vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const auto expectFactor = [](const Estimate& e, double truth, const char* what) {
    EXPECT_LE(e.error, 2e-3 * truth) << what;
    EXPECT_NEAR(e.value, truth, 3 * e.error + 2e-4 * truth) << what << ", standard error " << e.error;  // the second: 40 x 40 midpoints
  };
  const Estimate open = byRays([&](Scene& s, uint32_t m) { addQuad(s, z, y, x, m); }, vec3(0.0f), x, y);
  expectFactor(open, 0.1998248957, "opposite faces");
  expectFactor(byRays([&](Scene& s, uint32_t m) { addQuad(s, vec3(0.0f), z, x, m); }, vec3(0.0f), x, y), 0.2000437761,
               "adjacent faces");
  const Estimate blocked = byRays(
      [&](Scene& s, uint32_t m) {
        addQuad(s, z, y, x, m);
        addQuad(s, 0.5f * z, 0.5f * y, 0.5f * x, addMaterial(s, vec3(0.0f)));
      },
      vec3(0.0f), x, y);
  expectFactor(blocked, 0.1498686718, "quarter blocker");
}

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
