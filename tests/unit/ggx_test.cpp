// The lobe of glossy surfaces against the same formulas and their integrals in double.
#include "shaders/shared/ggx.h"

#include <gtest/gtest.h>

#include "tests/ggx_integral.h"

namespace hl {
namespace {

using namespace hl::test;
using shared::Random;

constexpr float kRoughnesses[] = {shared::kMinRoughness, 0.1f, 0.2f, 0.5f, 0.8f, 1.0f};
constexpr float kCosines[] = {0.1f, 0.3f, 0.7f, 1.0f};

vec2 uniform2(Random& r) {
  const float x = shared::randomFloat(r);
  return vec2(x, shared::randomFloat(r));
}
vec3 viewOf(float cosine) { return vec3(std::sqrt(1 - cosine * cosine), 0, cosine); }
double alphaOf(float roughness) { return static_cast<double>(roughness) * static_cast<double>(roughness); }

TEST(Ggx, DistributionIsOneFacetAnArea) {
  for (const float roughness : kRoughnesses) {
    // Integral of D cos over the hemisphere; tan(theta) = alpha t is the scale on which D changes, t = x / (1 - x).
    constexpr int kSteps = 20000;
    const double alpha = alphaOf(roughness);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = (i + 0.5) / kSteps, tangent = alpha * x / (1 - x), z = 1 / std::sqrt(1 + tangent * tangent);
      const double dz = z * z * z * tangent * alpha / ((1 - x) * (1 - x)) / kSteps;
      const vec3 h(static_cast<float>(tangent * z), 0, static_cast<float>(z));
      sum += 2 * kPiDouble * z * dz * static_cast<double>(shared::ggxDistribution(h, shared::ggxAlpha(roughness)));
    }
    EXPECT_NEAR(sum, 1, 1e-4) << roughness;
  }
}

TEST(Ggx, FollowsTheFormulaAndIsReciprocal) {
  Random r = shared::randomInit(1, 2, 3);
  for (const float roughness : kRoughnesses)
    for (int i = 0; i < 2000; ++i) {
      const vec3 f0(shared::randomFloat(r), 0, 1), view = shared::sampleUniformHemisphere(uniform2(r));
      // Half of the lights in the peak, where single precision has least to hold on to.
      const vec3 light = i % 2 ? shared::sampleUniformHemisphere(uniform2(r)) : shared::sampleGgx(view, f0, roughness, uniform2(r)).light;
      if (light.z < 0.02f || view.z < 0.02f) continue;  // rounding of the two directions' lengths decides beyond that
      const vec3 f = shared::ggxBrdf(view, light, f0, roughness), back = shared::ggxBrdf(light, view, f0, roughness);
      const double truth = ggxLobe(glm::normalize(glm::dvec3(view)), glm::normalize(glm::dvec3(light)), static_cast<double>(f0.x), alphaOf(roughness));
      // In the narrowest peak a direction's rounding of 6e-8 is 2e-5 of its width.
      EXPECT_NEAR(static_cast<double>(f.x), truth, 1e-3 * truth) << roughness;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(f[c], back[c], 1e-5f * f.z) << roughness;
    }
  EXPECT_EQ(shared::ggxBrdf(vec3(0, 0, 1), glm::normalize(vec3(1, 0, -0.1f)), vec3(1.0f), 0.5f), vec3(0.0f));
  EXPECT_EQ(shared::ggxBrdf(glm::normalize(vec3(1, 0, -0.1f)), vec3(0, 0, 1), vec3(1.0f), 0.5f), vec3(0.0f));
}

TEST(Ggx, SamplesWeighAsTheirDensitySays) {
  Random r = shared::randomInit(4, 5, 6);
  for (const float roughness : kRoughnesses)
    for (const float cosine : kCosines) {
      const vec3 view = viewOf(cosine), f0(0.04f, 0.5f, 1);
      constexpr int kSamples = 1 << 14;
      int above = 0;
      for (int i = 0; i < kSamples; ++i) {
        const shared::GgxSample s = shared::sampleGgx(view, f0, roughness, uniform2(r));
        ASSERT_NEAR(glm::length(s.light), 1, 1e-5f);
        ASSERT_TRUE(s.weight.x >= 0 && s.weight.z <= 1 + 1e-6f) << s.weight.z;
        if (s.light.z > 0 && s.weight != vec3(0.0f)) ++above;
        if (s.light.z < 1e-3f) continue;
        const vec3 want = shared::ggxBrdf(view, s.light, f0, roughness) * (s.light.z / shared::ggxPdf(view, s.light, roughness));
        // Both have the same peak, met at a normal that is a rounding away.
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(s.weight[c], want[c], 2e-4f + 1e-3f * want[c]) << roughness << " " << cosine;
      }
      // The density's integral is the share of samples above the surface.
      const double whole = overLobe(glm::normalize(glm::dvec3(view)), alphaOf(roughness), 600,
                                    [&](const glm::dvec3& light) { return static_cast<double>(shared::ggxPdf(view, vec3(light), roughness)); });
      EXPECT_NEAR(whole, static_cast<double>(above) / kSamples, 4 * std::sqrt(std::max(1e-4, whole * (1 - whole)) / kSamples) + (cosine < 0.2f ? 6e-3 : 1e-3)) << roughness << " " << cosine;
    }
}

TEST(Ggx, SamplesAddUpToTheDirectionalAlbedo) {
  Random r = shared::randomInit(7, 8, 9);
  for (const float roughness : kRoughnesses)
    for (const float cosine : kCosines) {
      // Linear in f0.
      const double black = directionalAlbedo(0, static_cast<double>(cosine), static_cast<double>(roughness), 500);
      const double white = directionalAlbedo(1, static_cast<double>(cosine), static_cast<double>(roughness), 500);
      EXPECT_LE(white, 1 + 1e-6) << "a white furnace gains nothing";
      const double quadrature = cosine < 0.2f ? 3e-3 : 5e-4;  // the horizon cuts the midpoint rule's lobe
      for (const float f0 : {0.04f, 0.5f, 1.0f}) {
        constexpr int kSamples = 1 << 14;
        double sum = 0, squares = 0;
        for (int i = 0; i < kSamples; ++i) {
          const double w = static_cast<double>(shared::sampleGgx(viewOf(cosine), vec3(f0), roughness, uniform2(r)).weight.x);
          sum += w, squares += w * w;
        }
        const double mean = sum / kSamples, error = std::sqrt(std::max(0.0, squares / kSamples - mean * mean) / kSamples);
        const double truth = black + static_cast<double>(f0) * (white - black);
        EXPECT_NEAR(mean, truth, 4 * error + quadrature) << roughness << " " << cosine << " " << f0;
        EXPECT_NEAR(static_cast<double>(shared::ggxDirectionalAlbedo(vec3(f0), cosine, roughness, 1024).x), truth, 5e-4 + quadrature) << roughness << " " << cosine << " " << f0;
      }
    }
  // A smooth mirror keeps all; a rough one loses what would be reflected between facets.
  EXPECT_GT(directionalAlbedo(1, 1, static_cast<double>(shared::kMinRoughness)), 0.9999);
  EXPECT_LT(directionalAlbedo(1, 1, 1), 0.95);
}

TEST(Ggx, IsFiniteAtTheEdges) {
  for (const float roughness : {0.0f, shared::kMinRoughness, 1.0f})
    for (const float z : {0.0f, 1e-20f, 1e-6f, 1.0f})
      for (const float u : {0.0f, 0.5f, 0.99999994f}) {
        const vec3 view = glm::normalize(vec3(std::sqrt(std::max(0.0f, 1 - z * z)), 0, z));
        const shared::GgxSample s = shared::sampleGgx(view, vec3(0.5f), roughness, vec2(u, u));
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(s.weight[c]) && std::isfinite(s.light[c])) << roughness << " " << z << " " << u;
      }
}

}  // namespace
}  // namespace hl
