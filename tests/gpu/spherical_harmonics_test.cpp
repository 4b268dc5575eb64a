// Shaders make of the one definition what double precision makes of it, to 1e-5.
#include "engine/core/spherical_harmonics64.h"

#include <random>

#include "tests/gpu_fixture.h"

namespace hl {
namespace {

struct Question {  // as in tests/shaders/spherical_harmonics.comp
  int order = sh64::kShMaxOrder;
  vec3 direction;
  glm::mat3 rotation;
  float c[sh64::kShMaxCoefficients];
};
struct Answer {
  float basis[sh64::kShMaxCoefficients], turned[sh64::kShMaxCoefficients];
  float value;
  float clampedCosine[sh64::kShMaxOrder + 1], hann[sh64::kShMaxOrder + 1], lanczos[sh64::kShMaxOrder + 1];
};

class SphericalHarmonicsOnTheDevice : public test::GpuTest {};

TEST_F(SphericalHarmonicsOnTheDevice, AgreeWithDoublePrecision) {
  std::mt19937 g(1);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    const double x = normal(g), y = normal(g);
    return glm::normalize(glm::dvec3(x, y, normal(g)));
  };
  std::vector<Question> questions(512);
  for (size_t i = 0; i < questions.size(); ++i) {
    Question& q = questions[i];
    const glm::dvec3 poles[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
    q.direction = vec3(i < 4 ? poles[i] : direction());
    const glm::dvec3 a = direction(), b = glm::normalize(glm::cross(a, direction()));
    q.rotation = glm::mat3(i == 0 ? glm::dmat3(1) : glm::dmat3(a, b, glm::cross(a, b)));
    for (float& c : q.c) c = static_cast<float>(normal(g));
  }
  const Buffer in = device->buffer("questions", std::span<const Question>(questions));
  const Buffer out = device->buffer("answers", questions.size() * sizeof(Answer));
  graph->compute("harmonics", "tests/spherical_harmonics.comp")
      .bind("questions_block", in, Access::Read)
      .bind("answers_block", out, Access::Write)
      .dispatchThreads(static_cast<uint32_t>(questions.size()));
  graph->execute();
  const auto answers = download<Answer>(out);
  for (size_t i = 0; i < questions.size(); ++i) {
    const Question& q = questions[i];
    const Answer& r = answers[i];
    sh64::ShCoefficients f;
    for (int k = 0; k < sh64::kShMaxCoefficients; ++k) f.c[k] = static_cast<double>(q.c[k]);
    const glm::dvec3 d(q.direction);
    const sh64::ShCoefficients y = sh64::shBasis(sh64::kShMaxOrder, d), turned = sh64::shRotate(sh64::kShMaxOrder, f, glm::dmat3(q.rotation));
    for (int k = 0; k < sh64::kShMaxCoefficients; ++k) {
      ASSERT_NEAR(static_cast<double>(r.basis[k]), y.c[k], 1e-5) << i << " " << k;
      ASSERT_NEAR(static_cast<double>(r.turned[k]), turned.c[k], 1e-5) << i << " " << k;
    }
    ASSERT_NEAR(static_cast<double>(r.value), sh64::shEvaluate(sh64::kShMaxOrder, f, d), 2e-5) << "a sum of 81 terms";
    for (int l = 0; l <= sh64::kShMaxOrder; ++l) {
      ASSERT_NEAR(static_cast<double>(r.clampedCosine[l]), sh64::shClampedCosine(l), 1e-5);
      ASSERT_NEAR(static_cast<double>(r.hann[l]), sh64::shWindow(sh64::kShWindowHann, l, sh64::kShMaxOrder), 1e-5);
      ASSERT_NEAR(static_cast<double>(r.lanczos[l]), sh64::shWindow(sh64::kShWindowLanczos, l, sh64::kShMaxOrder), 1e-5);
    }
  }
}

}  // namespace
}  // namespace hl
