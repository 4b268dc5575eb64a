// The reference where the answer is known: enclosures and form factors by rays.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/scene/scene_file.h"
#include "tests/analytic/reference_fixture.h"

namespace hl {
namespace {

using namespace hl::test;

constexpr double kPiD = 3.14159265358979323846;

// MEASURES.md section 1: 10 m, 50 000 cd in the centre, rho = 2/3, luminance rho / pi (direct + indirect).
TEST(ReferenceClosedForms, PointLightCube) {
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
TEST(ReferenceClosedForms, SphereIsUniform) {
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
TEST(ReferenceClosedForms, CubeByAlbedo) {
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
TEST(ReferenceClosedForms, AbsorbedEqualsEmitted) {
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

/// All light of `keyhole_room` comes through its keyhole: what the room absorbs of reflected light is what it reflected of the lamp's flux through it. (The cupboard is black, and what goes
/// back through the hole 7e-5.)
TEST(ReferenceClosedForms, KeyholeRoom) {
  const Scene scene = loadScene("keyhole_room");
  const double a = 0.015, b = 0.04, d = 0.4, rho = 0.7;
  const double flux = static_cast<double>(scene.pointLights.at(0).intensity.y) * 4 * std::atan(a * b / (d * std::sqrt(d * d + a * a + b * b)));
  ReferenceSettings settings;
  settings.samplesPerPixel = 64;
  const auto result = trace(scene, receiversOverSurface(scene, 8192), settings);
  const Estimate mean = meanOf(result->indirectImage(kAllBounces));
  const double absorbed = mean.value * surfaceArea(scene) * (1 - rho), error = mean.error * surfaceArea(scene) * (1 - rho);
  std::printf("keyhole: absorbed of reflected light %.3f +- %.3f W, reflected %.3f W\n", absorbed, error, rho * flux);
  EXPECT_NEAR(absorbed, rho * flux, 3 * error + 1e-3 * rho * flux);
  EXPECT_LT(error, 0.02 * rho * flux);
}

TEST(ReferenceClosedForms, FormFactorsByRays) {
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

}  // namespace
}  // namespace hl
