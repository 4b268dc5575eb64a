// shaders/shared/sampling.h and ggx.h are one source for two languages: both must make the same of it.
#include "shaders/shared/ggx.h"

#include <algorithm>
#include <cmath>

#include "tests/gpu_fixture.h"

namespace hl {
namespace {

struct Numbers {  // as in tests/shaders/sampling.comp
  vec2 u;
  uint32_t index, seed;
  vec3 p0, p1, p2, normal;
};
struct Sampled {
  vec3 cosine, sphere, hemisphere, world;
  vec2 triangle;
  vec3 lightDirection;
  float lightDistance, lightPdf, solidAngle, formFactor, weight, falloff;
  vec2 r2, sobol, shuffled;
  vec3 lobeLight, lobeWeight, lobe;
  float lobePdf;
  vec2 lobeAlbedo;
};

class SamplingOnTheDevice : public test::GpuTest {};

TEST_F(SamplingOnTheDevice, AgreesWithTheHost) {
  constexpr size_t kCount = 4096;
  std::vector<Numbers> numbers(kCount);
  shared::Random r = shared::randomInit(1, 2, 3);
  const auto number = [&] { return shared::randomFloat(r); };
  const auto direction = [&] {
    const float x = number();
    return shared::sampleUniformSphere(vec2(x, number()));
  };
  for (Numbers& n : numbers) {
    const float x = number();
    n.u = vec2(x, number());
    n.index = shared::randomUint(r) >> (shared::randomUint(r) & 31u), n.seed = shared::randomUint(r);
    // Triangles near and far, small and large; the plane's distance is kept from 0, where any float is right.
    const vec3 to = direction() * std::exp2(8 * number() - 2);
    const float size = glm::length(to) * std::exp2(-8 * number());
    n.p0 = to, n.p1 = to + direction() * size, n.p2 = to + direction() * size;
    n.normal = direction();
  }
  const Buffer in = device->buffer("numbers", std::span<const Numbers>(numbers));
  const Buffer out = device->buffer("sampled", kCount * sizeof(Sampled));
  graph->compute("sample", "tests/sampling.comp")
      .bind("numbers_block", in, Access::Read)
      .bind("sampled_block", out, Access::Write)
      .dispatchThreads(kCount);
  graph->execute();
  const auto sampled = download<Sampled>(out);
  size_t lights = 0;
  for (size_t i = 0; i < kCount; ++i) {
    const Numbers& n = numbers[i];
    const Sampled& s = sampled[i];
    const vec3 cosine = shared::sampleCosineHemisphere(n.u);
    ASSERT_LT(glm::length(s.cosine - cosine), 2e-5f) << i;
    ASSERT_LT(glm::length(s.sphere - shared::sampleUniformSphere(n.u)), 2e-5f) << i;
    ASSERT_LT(glm::length(s.hemisphere - shared::sampleUniformHemisphere(n.u)), 2e-5f) << i;
    ASSERT_LT(glm::length(s.world - shared::fromLocal(cosine, n.normal)), 3e-5f) << i;
    ASSERT_EQ(s.triangle, shared::sampleTriangle(n.u)) << i;
    ASSERT_EQ(s.r2, shared::r2Point(n.index, uvec2(n.seed, n.seed ^ 0x5bd1e995u))) << i;
    ASSERT_EQ(s.sobol, shared::sobolPoint(n.index, uvec2(n.seed, n.seed ^ 0x5bd1e995u))) << i;
    ASSERT_EQ(s.shuffled, shared::shuffledSobolPoint(n.index, n.seed)) << i;
    ASSERT_NEAR(s.weight, shared::powerHeuristic(n.u.x, n.u.y) - 2 * shared::balanceHeuristic(n.u.x, n.u.y), 1e-5f) << i;
    ASSERT_NEAR(s.falloff, shared::spotFalloff(n.u.x, 0.9f, 0.2f), 1e-5f) << i;
    const float roughness = static_cast<float>(n.index & 7u) / 7;
    const vec3 view(n.normal.x, n.normal.y, std::abs(n.normal.z)), f0(0.04f, 0.5f, 1);
    // In the narrowest peak, and along the horizon, the last bits of a direction decide.
    if (view.z > 0.05f) {
      const shared::GgxSample g = shared::sampleGgx(view, f0, roughness, n.u);
      const vec3 light = shared::toLocal(s.world, n.normal), lobe = shared::ggxBrdf(view, light, f0, roughness);
      const float pdf = shared::ggxPdf(view, light, roughness);
      ASSERT_LT(glm::length(s.lobeLight - g.light), 1e-3f) << i;
      if (g.light.z > 0.01f) {
        ASSERT_LT(glm::length(s.lobeWeight - g.weight), 5e-3f) << i;
      }
      if (light.z > 0.01f) {
        ASSERT_LT(glm::length(s.lobe - lobe), 1e-2f * glm::length(lobe) + 1e-5f) << i;
        ASSERT_NEAR(s.lobePdf, pdf, 1e-2f * pdf + 1e-5f) << i;
      }
      ASSERT_LT(glm::length(s.lobeAlbedo - shared::ggxScaleAndBias(view.z, roughness, 16)), 2e-2f) << i;
    }
    // What a triangle seen edge-on gives depends on the last bits of its corners.
    const vec3 across = glm::cross(n.p1 - n.p0, n.p2 - n.p0);
    if (std::abs(glm::dot(across, n.p0)) < 0.05f * glm::length(across) * glm::length(n.p0)) continue;
    if (glm::length(across) < 0.05f * glm::length(n.p1 - n.p0) * glm::length(n.p2 - n.p0)) continue;
    const float solidAngle = shared::triangleSolidAngle(vec3(0.0f), n.p0, n.p1, n.p2);
    ASSERT_NEAR(s.solidAngle, solidAngle, 5e-4f * solidAngle) << i;
    ASSERT_NEAR(s.formFactor, shared::triangleFormFactor(vec3(0.0f), n.normal, n.p0, n.p1, n.p2), 2e-5f) << i;
    const shared::TriangleSample t = shared::sampleTriangleLight(vec3(0.0f), n.p0, n.p1, n.p2, n.u);
    // The two may differ on whether a triangle is small enough to be sampled by area.
    if (std::abs(s.lightPdf - t.pdf) > 1e-2f * t.pdf) continue;
    ++lights;
    ASSERT_LT(glm::length(s.lightDirection - t.direction), 2e-3f) << i;
    ASSERT_NEAR(s.lightDistance, t.distance, 1e-2f * t.distance) << i;
  }
  EXPECT_GT(lights, kCount * 3 / 4);
}

}  // namespace
}  // namespace hl
