#include "engine/reference/form_factor.h"

#include <array>

namespace hl {
namespace {

// Gauss-Legendre, 8 points on [-1, 1].
constexpr std::array<double, 8> kNodes = {-0.96028985649753623, -0.79666647741362674, -0.52553240991632899,
                                          -0.18343464249564980, 0.18343464249564980,  0.52553240991632899,
                                          0.79666647741362674,  0.96028985649753623};
constexpr std::array<double, 8> kWeights = {0.10122853629037626, 0.22238103445337447, 0.31370664587788729,
                                            0.36268378337836198, 0.36268378337836198, 0.31370664587788729,
                                            0.22238103445337447, 0.10122853629037626};

}  // namespace

double meanOverParallelogram(const glm::dvec3& corner, const glm::dvec3& e1, const glm::dvec3& e2, int cells,
                             double grading, const std::function<double(const glm::dvec3&)>& f) {
  const auto edge = [&](int i) { return i == 0 ? 0.0 : std::pow(grading, static_cast<double>(cells - i)); };
  double sum = 0;
  for (int j = 0; j < cells; ++j) {
    const double t0 = grading < 1 ? edge(j) : static_cast<double>(j) / cells;
    const double t1 = grading < 1 ? edge(j + 1) : static_cast<double>(j + 1) / cells;
    for (int i = 0; i < cells; ++i) {
      const double s0 = static_cast<double>(i) / cells, s1 = static_cast<double>(i + 1) / cells;
      for (size_t q = 0; q < kNodes.size(); ++q)
        for (size_t p = 0; p < kNodes.size(); ++p) {
          const double s = 0.5 * (s0 + s1) + 0.5 * (s1 - s0) * kNodes[p];
          const double t = 0.5 * (t0 + t1) + 0.5 * (t1 - t0) * kNodes[q];
          sum += 0.25 * (s1 - s0) * (t1 - t0) * kWeights[p] * kWeights[q] * f(corner + s * e1 + t * e2);
        }
    }
  }
  return sum;
}

}  // namespace hl
