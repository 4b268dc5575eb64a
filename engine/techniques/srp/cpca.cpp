#include "engine/techniques/srp/cpca.h"

#include <Eigen/Cholesky>
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
  const Matrix kept = leading(a, settings, settings.most, result.total, limit, result.singularValues);
  result.rank = static_cast<uint32_t>(kept.cols());
  Matrix weights = a * kept;
  // By what the weights hold: exact for any orthonormal vectors, those of the range finder too.
  result.discarded = std::max(0.0, result.total - weights.squaredNorm());
  Matrix lights(columns, settings.keep.size());
  Eigen::Index lit = 0;
  for (const std::vector<float>& numbers : settings.keep) {
    const Eigen::VectorXd light = Eigen::Map<const Eigen::VectorXf>(numbers.data(), columns).cast<double>().normalized();
    if ((kept.transpose() * light).squaredNorm() >= kLeastHeld) lights.col(lit++) = light;
  }
  lights.conservativeResize(Eigen::NoChange, lit);
  if (lit > 0) {
    // All of them together: vectors may hold a little of several.
    const Matrix held = kept.transpose() * lights;
    const Matrix change = (held.transpose() * held).ldlt().solve((a * lights - weights * held).transpose()).transpose() * held.transpose();
    if (change.allFinite()) {
      weights += change;
      result.discarded += change.squaredNorm();
    }
  }
  result.basis.resize(static_cast<size_t>(result.rank) * columns);
  result.weights.resize(static_cast<size_t>(rows) * result.rank);
  for (uint32_t k = 0; k < result.rank; ++k) {
    for (uint32_t i = 0; i < columns; ++i) result.basis[static_cast<size_t>(k) * columns + i] = static_cast<float>(kept(i, k));
    for (uint32_t r = 0; r < rows; ++r) result.weights[static_cast<size_t>(r) * result.rank + k] = static_cast<float>(weights(r, k));
  }
  return result;
}

double decompositionWork(uint32_t rows, uint32_t columns, uint32_t most) {
  const double m = rows, n = columns, side = std::min(m, n), l = static_cast<double>(most) + kOversampling;
  const double project = m * n * std::min(static_cast<double>(most), side);
  // Eigenvectors by Householder reduction and QR steps: about 9 n^3.
  if (side <= kExactSide || side <= l) return m * n * side + 9 * side * side * side + project;
  // Products with A, each followed by a Householder QR (2 m l^2, and as much for Q), and the small matrix B B^T.
  return (2 + 2 * kPowerIterations) * m * n * l + (kPowerIterations + 1) * 4 * m * l * l + kPowerIterations * 4 * n * l * l + n * l * l + 9 * l * l * l + project;
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
