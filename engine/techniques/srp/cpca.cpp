#include "engine/techniques/srp/cpca.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace hl {
namespace {

using Matrix = Eigen::MatrixXd;

/// Directions beyond those wanted, and how often the range is sharpened: with two iterations a spectrum that falls as slowly as 1 / k loses under 1e-3 of
/// the energy kept (tested).
constexpr uint32_t kOversampling = 16;
constexpr int kPowerIterations = 2;
/// Singular values below this share of the largest are rounding.
constexpr double kRankTolerance = 1e-6;

Matrix orthonormal(const Matrix& m) {
  const Eigen::HouseholderQR<Matrix> qr(m);
  return qr.householderQ() * Matrix::Identity(m.rows(), m.cols());
}

/// Columns that span what `a` does to its largest directions.
Matrix range(const Matrix& a, uint32_t columns, uint32_t seed) {
  std::mt19937 engine(seed);  // numbers from the engine itself: distributions differ between libraries
  const auto uniform = [&] { return (static_cast<double>(engine()) + 0.5) / 4294967296.0 - 0.5; };
  Matrix omega(a.cols(), columns);
  for (Eigen::Index j = 0; j < omega.cols(); ++j)
    for (Eigen::Index i = 0; i < omega.rows(); ++i) omega(i, j) = uniform();
  Matrix q = orthonormal(a * omega);
  for (int i = 0; i < kPowerIterations; ++i) {
    q = orthonormal(a.transpose() * q);
    q = orthonormal(a * q);
  }
  return q;
}

/// The leading right singular vectors of `a`, one a column, largest first: at most `most`, and no more than leave out `limit` of `energy`.
Matrix leading(const Matrix& a, const ComponentSettings& settings, uint32_t most, double energy, double limit, std::vector<double>& singularValues) {
  const auto rows = static_cast<uint32_t>(a.rows()), columns = static_cast<uint32_t>(a.cols());
  // Left vectors, and the squares of singular values, smallest first: of A A^T, of A^T A, or of a small matrix with the same leading ones.
  const uint32_t side = std::min(rows, columns);
  Matrix right;  // columns x n, orthonormal
  Eigen::VectorXd squares;
  if (settings.exact || side <= kExactSide || side <= most + kOversampling) {
    if (columns <= rows) {
      const Eigen::SelfAdjointEigenSolver<Matrix> solver(a.transpose() * a);
      right = solver.eigenvectors();
      squares = solver.eigenvalues();
    } else {
      const Eigen::SelfAdjointEigenSolver<Matrix> solver(a * a.transpose());
      squares = solver.eigenvalues();
      right = a.transpose() * solver.eigenvectors();
      for (Eigen::Index i = 0; i < right.cols(); ++i) {
        const double n = right.col(i).norm();
        if (n > 0) right.col(i) /= n;
      }
    }
  } else {
    const Matrix b = range(a, most + kOversampling, settings.seed).transpose() * a;
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(b * b.transpose());
    squares = solver.eigenvalues();
    right = b.transpose() * solver.eigenvectors();
    for (Eigen::Index i = 0; i < right.cols(); ++i) {
      const double n = right.col(i).norm();
      if (n > 0) right.col(i) /= n;
    }
  }

  const auto count = static_cast<uint32_t>(squares.size());
  const double largest = std::max(0.0, squares(count - 1));
  uint32_t rank = 0;
  double left = energy;
  while (rank < std::min(most, count)) {
    const double square = squares(count - 1 - rank);
    if (!(square > kRankTolerance * kRankTolerance * largest)) break;
    if (settings.tolerance > 0 && left <= limit) break;
    singularValues.push_back(std::sqrt(square));
    left -= square;
    ++rank;
  }
  return right.rightCols(rank).rowwise().reverse();
}

}  // namespace

Components principalComponents(std::span<const float> values, uint32_t rows, uint32_t columns, const ComponentSettings& settings) {
  Components result;
  if (rows == 0 || columns == 0) return result;
  const Matrix a = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(values.data(), rows, columns).cast<double>();
  result.total = a.squaredNorm();
  if (!(result.total > 0)) return result;
  const double limit = settings.tolerance * settings.tolerance * result.total;
  Matrix kept;
  if (settings.keep.empty()) {
    kept = leading(a, settings, settings.most, result.total, limit, result.singularValues);
  } else {
    // The lights take the first vectors; what is left of the matrix has no part in them, and so its components stand at right angles to them.
    const uint32_t count = std::min(static_cast<uint32_t>(settings.keep.size()), std::max(1u, settings.most / 2));
    Matrix lights(columns, count);
    for (uint32_t i = 0; i < count; ++i) lights.col(i) = Eigen::Map<const Eigen::VectorXf>(settings.keep[i].data(), columns).cast<double>().normalized();
    const Matrix rest = a - (a * lights) * lights.transpose();
    const double energy = rest.squaredNorm();
    Matrix others(columns, 0);
    if (settings.most > count && energy > kRankTolerance * kRankTolerance * result.total)
      others = leading(rest, settings, settings.most - count, energy, limit, result.singularValues);
    kept.resize(columns, others.cols() + count);
    kept << lights, others;
  }
  result.rank = static_cast<uint32_t>(kept.cols());
  const Matrix weights = a * kept;
  // By what the weights hold: exact for any orthonormal vectors, those of the range finder too.
  result.discarded = std::max(0.0, result.total - weights.squaredNorm());
  result.basis.resize(static_cast<size_t>(result.rank) * columns);
  result.weights.resize(static_cast<size_t>(rows) * result.rank);
  for (uint32_t k = 0; k < result.rank; ++k) {
    for (uint32_t i = 0; i < columns; ++i) result.basis[static_cast<size_t>(k) * columns + i] = static_cast<float>(kept(i, k));
    for (uint32_t r = 0; r < rows; ++r) result.weights[static_cast<size_t>(r) * result.rank + k] = static_cast<float>(weights(r, k));
  }
  return result;
}

std::vector<std::vector<float>> constantLights(std::span<const float> matrix, uint32_t rows, uint32_t columns, uint32_t coefficients) {
  // A probe with less than this share of a receiver's transport does not join that receiver's others.
  constexpr double kLeastShare = 1e-3;
  const uint32_t probes = columns / coefficients;
  std::vector<uint32_t> group(probes);
  std::iota(group.begin(), group.end(), 0u);
  const auto root = [&](uint32_t p) {
    while (group[p] != p) p = group[p] = group[group[p]];
    return p;
  };
  std::vector<double> energyOf(probes, 0.0);
  for (uint32_t r = 0; r < rows; ++r) {
    std::vector<double> energy(probes, 0.0);
    double total = 0;
    for (uint32_t i = 0; i < columns; ++i) {
      const auto v = static_cast<double>(matrix[size_t{r} * columns + i]);
      energy[i / coefficients] += v * v, total += v * v;
    }
    uint32_t first = probes;
    for (uint32_t p = 0; p < probes; ++p) {
      energyOf[p] += energy[p];
      if (!(energy[p] > kLeastShare * kLeastShare * total)) continue;
      if (first == probes) first = root(p);
      else group[std::max(first, root(p))] = std::min(first, root(p)), first = root(first);
    }
  }
  std::vector<double> weight(probes, 0.0);
  for (uint32_t p = 0; p < probes; ++p) weight[root(p)] += energyOf[p];
  std::vector<uint32_t> roots;
  for (uint32_t p = 0; p < probes; ++p)
    if (root(p) == p && weight[p] > 0) roots.push_back(p);
  std::stable_sort(roots.begin(), roots.end(), [&](uint32_t x, uint32_t y) { return weight[x] > weight[y]; });
  std::vector<std::vector<float>> lights;
  for (uint32_t g : roots) {
    lights.emplace_back(columns, 0.0f);
    for (uint32_t p = 0; p < probes; ++p)
      if (root(p) == g) lights.back()[size_t{p} * coefficients] = 1.0f;
  }
  return lights;
}

}  // namespace hl
