// The polygon oracle against closed forms (MEASURES.md section 1), and what single precision keeps of it.
#include "engine/reference/form_factor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "shaders/shared/sampling.h"

namespace hl {
namespace {

using glm::dvec3;
using Quad = std::array<dvec3, 4>;

constexpr double kPiD = 3.14159265358979323846;

double toQuad(const dvec3& from, const dvec3& n, const Quad& q) {
  return pointToPolygon<double>(from, n, std::span<const dvec3>(q));
}

Quad quad(const dvec3& corner, const dvec3& e1, const dvec3& e2) {
  return {corner, corner + e1, corner + e1 + e2, corner + e2};
}

TEST(FormFactor, ParallelRectangles) {
  for (const auto& [a, b, c] : {std::array{1.0, 1.0, 1.0}, {2.0, 0.5, 1.0}, {1.0, 1.0, 3.0}, {4.0, 3.0, 1.0}}) {
    const double X = a / c, Y = b / c, x2 = 1 + X * X, y2 = 1 + Y * Y;
    const double truth =
        2 / (kPiD * X * Y) *
        (std::log(std::sqrt(x2 * y2 / (1 + X * X + Y * Y))) + X * std::sqrt(y2) * std::atan(X / std::sqrt(y2)) +
         Y * std::sqrt(x2) * std::atan(Y / std::sqrt(x2)) - X * std::atan(X) - Y * std::atan(Y));
    const Quad far = quad(dvec3(0, 0, c), dvec3(a, 0, 0), dvec3(0, b, 0));
    const double f = meanOverParallelogram(dvec3(0), dvec3(a, 0, 0), dvec3(0, b, 0), 6, 1,
                                           [&](const dvec3& p) { return toQuad(p, dvec3(0, 0, 1), far); });
    EXPECT_NEAR(f, truth, 1e-9) << a << " x " << b << " at " << c;
  }
}

/// From a floor of width w to a wall of height h that share an edge of length 1.
double perpendicular(double h, double w) {
  const Quad wall = quad(dvec3(0), dvec3(1, 0, 0), dvec3(0, h, 0));
  return meanOverParallelogram(dvec3(0), dvec3(1, 0, 0), dvec3(0, 0, w), 24, 0.5,
                               [&](const dvec3& p) { return toQuad(p, dvec3(0, 1, 0), wall); });
}

TEST(FormFactor, PerpendicularRectanglesAndTheCube) {
  EXPECT_NEAR(perpendicular(1, 1), 0.2000437761, 1e-7);
  EXPECT_NEAR(perpendicular(2, 1), 0.2328526028, 1e-7);
  EXPECT_NEAR(perpendicular(0.1, 1), 0.0432513694, 1e-7);
  const Quad far = quad(dvec3(0, 1, 0), dvec3(1, 0, 0), dvec3(0, 0, 1));
  const double opposite = meanOverParallelogram(dvec3(0), dvec3(1, 0, 0), dvec3(0, 0, 1), 6, 1, [&](const dvec3& p) {
    return toQuad(p, dvec3(0, 1, 0), far);
  });
  EXPECT_NEAR(opposite, 0.1998248957, 1e-9);
  EXPECT_NEAR(opposite + 4 * perpendicular(1, 1), 1, 2e-7) << "a closed room's row sum";
}

TEST(FormFactor, CoaxialDiscs) {
  for (const auto& [r1, r2, a, truth] :
       {std::array{1.0, 1.0, 1.0, 0.3819660113}, {1.0, 1.0, 2.0, 0.1715728753}}) {
    constexpr int kSides = 2048;
    // Of the disc's area, so that the polygon's error is of the fourth order in its sides.
    const double angle = 2 * kPiD / kSides, r = r2 * std::sqrt(angle / std::sin(angle));
    std::vector<dvec3> disc;
    for (int i = 0; i < kSides; ++i) disc.push_back(dvec3(r * std::cos(angle * i), r * std::sin(angle * i), a));
    // Rings of equal area: the integration variable is the squared radius.
    const double rim = r1;
    const double f = meanOverParallelogram(dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0), 1, 1, [&](const dvec3& p) {
      return pointToPolygon<double>(dvec3(rim * std::sqrt(p.x), 0, 0), dvec3(0, 0, 1), disc);
    });
    EXPECT_NEAR(f, truth, 1e-8) << "distance " << a;
  }
}

TEST(FormFactor, PointOverASquare) {
  const Quad square = quad(dvec3(-0.5, -0.5, 1), dvec3(1, 0, 0), dvec3(0, 1, 0));
  EXPECT_NEAR(toQuad(dvec3(0), dvec3(0, 0, 1), square), 0.2394564705, 1e-10);
  EXPECT_EQ(toQuad(dvec3(0), dvec3(0, 0, -1), square), 0) << "below the horizon";
  // Tilted by a right angle: half of it is cut off, and the halves of the two sides are alike.
  const double left = toQuad(dvec3(0), dvec3(-1, 0, 0), square), right = toQuad(dvec3(0), dvec3(1, 0, 0), square);
  EXPECT_GT(left, 0);
  EXPECT_NEAR(left, right, 1e-15);
}

TEST(FormFactor, QuarterBlocker) {
  const Quad far = quad(dvec3(0, 0, 1), dvec3(1, 0, 0), dvec3(0, 1, 0));
  const auto visible = [&](const dvec3& p) {
    // The blocker [0, 0.5]^2 half-way shadows [0, 1 - x] x [0, 1 - y] of the far square.
    const Quad shadow = quad(dvec3(0, 0, 1), dvec3(1 - p.x, 0, 0), dvec3(0, 1 - p.y, 0));
    return toQuad(p, dvec3(0, 0, 1), far) - toQuad(p, dvec3(0, 0, 1), shadow);
  };
  EXPECT_NEAR(meanOverParallelogram(dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0), 6, 1, visible), 0.1498686718, 1e-9);
  EXPECT_NEAR(0.75 * 0.1998248957, 0.1498686718, 1e-10) << "the table against itself";
}

TEST(FormFactor, ElementInTheCorner) {
  const Quad wall = quad(dvec3(0), dvec3(1, 0, 0), dvec3(0, 1, 0));
  const std::array<vec3, 4> wallF = {vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0)};
  const std::array<std::array<double, 2>, 4> table = {{{1, 0.0557}, {0.1, 0.2217}, {0.01, 0.24716}, {0.001, 0.24972}}};
  for (const auto& [c, shown] : table) {
    const double s = std::sqrt(1 + c * c);
    const double truth = (std::atan(1 / c) - c / s * std::atan(1 / s)) / (2 * kPiD);
    EXPECT_NEAR(truth, shown, 6e-5) << "the closed form against the table";
    EXPECT_NEAR(toQuad(dvec3(0, 0, c), dvec3(0, 1, 0), wall), truth, 1e-12) << c;
    const vec3 at(0, 0, static_cast<float>(c));
    const double f = static_cast<double>(shared::triangleFormFactor(at, vec3(0, 1, 0), wallF[0], wallF[1], wallF[2])) +
                     static_cast<double>(shared::triangleFormFactor(at, vec3(0, 1, 0), wallF[0], wallF[2], wallF[3]));
    EXPECT_NEAR(f, truth, 1e-6) << c << " in single precision";
  }
  EXPECT_NEAR(toQuad(dvec3(0, 0, 1e-12), dvec3(0, 1, 0), wall), 0.25, 1e-9);
}

// What the rectangle's closed form loses in single precision and the polygon sum keeps.
TEST(FormFactor, SinglePrecisionFarAway) {
  for (const float distance : {1.0f, 100.0f, 1000.0f}) {
    const std::array<glm::vec3, 4> q = {vec3(-0.5f, -0.5f, distance), vec3(0.5f, -0.5f, distance),
                                        vec3(0.5f, 0.5f, distance), vec3(-0.5f, 0.5f, distance)};
    const Quad d = {dvec3(q[0]), dvec3(q[1]), dvec3(q[2]), dvec3(q[3])};
    for (const dvec3& n : {dvec3(0, 0, 1), glm::normalize(dvec3(0.3, -0.5, 1))}) {
      const double truth = toQuad(dvec3(0), n, d);
      // Where the point faces the square no edge's share cancels another's; tilted, they do by the ratio of distance to size.
      const double kept = n.x == 0 ? 5e-7 : 1e-7 * std::max(5.0, static_cast<double>(distance));
      EXPECT_NEAR(static_cast<double>(pointToPolygon<float>(vec3(0), vec3(n), q)), truth, kept * truth) << distance;
      const double f = static_cast<double>(shared::triangleFormFactor(vec3(0), vec3(n), q[0], q[1], q[2])) +
                       static_cast<double>(shared::triangleFormFactor(vec3(0), vec3(n), q[0], q[2], q[3]));
      EXPECT_NEAR(f, truth, 1e-6 * truth) << distance;
    }
  }
}

// Cut by the horizon in every way: the triangle's halves, wherever it is cut, sum to the whole.
TEST(FormFactor, HorizonCutsAddUp) {
  shared::Random r = shared::randomInit(3, 1, 4);
  const auto signedFloat = [&] { return 2 * shared::randomFloat(r) - 1; };
  for (int i = 0; i < 2000; ++i) {
    const vec3 p0(signedFloat(), signedFloat(), signedFloat()), p1(signedFloat(), signedFloat(), signedFloat()),
        p2(signedFloat(), signedFloat(), signedFloat());
    const vec3 n = shared::sampleUniformSphere(vec2(shared::randomFloat(r), shared::randomFloat(r)));
    const std::array<dvec3, 3> d = {dvec3(p0), dvec3(p1), dvec3(p2)};
    const double truth = pointToPolygon<double>(dvec3(0), dvec3(n), d);
    EXPECT_NEAR(static_cast<double>(shared::triangleFormFactor(vec3(0), n, p0, p1, p2)), truth, 5e-6);
    const dvec3 cut = d[1] + 0.3 * (d[2] - d[1]);
    const std::array<dvec3, 3> a = {d[0], d[1], cut}, b = {d[0], cut, d[2]};
    EXPECT_NEAR(pointToPolygon<double>(dvec3(0), dvec3(n), a) + pointToPolygon<double>(dvec3(0), dvec3(n), b), truth, 1e-12);
  }
}

}  // namespace
}  // namespace hl
