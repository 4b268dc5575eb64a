#pragma once
// Principal components of a cluster's transport (Bennett 2019, section 4.5; Sloan et al. 2003, without a mean): the truncated singular value
// decomposition of its matrix. Eigen's headers are in cpca.cpp alone.
#include <cstdint>
#include <span>
#include <vector>

namespace hl {

struct Components {
  uint32_t rank = 0;
  std::vector<float> basis;     ///< rank x columns, orthonormal rows: V^T
  std::vector<float> weights;   ///< rows x rank: U Sigma
  std::vector<double> singularValues;  ///< those kept, largest first
  double total = 0;             ///< squared Frobenius norm of the matrix
  double discarded = 0;         ///< ... of what is missing from it: of the exact decomposition, without lights to keep, the sum of the discarded singular values' squares
};

struct ComponentSettings {
  uint32_t most = 32;           ///< vectors at most
  double tolerance = 0;         ///< no more than leave out this share of the Frobenius norm; 0: as many as `most`
  bool exact = false;           ///< by all eigenvalues of the smaller Gram matrix, however large it is
  uint32_t seed = 1;            ///< of the randomised range finder
  /// Lights (one number a column each) whose transport comes out exactly: each row's weights are moved by the least that does it. No two may share a column. One of which the
  /// vectors hold less than kLeastHeld is left alone: the least that does it would be much.
  std::vector<std::vector<float>> keep = {};
};

/// Above this many rows and columns the range of the matrix is found by random projections with power iterations (Halko, Martinsson and Tropp 2011, algorithms
/// 4.4 and 5.1), in double precision: nearly the best `most` vectors (tested) for a fraction of the time.
inline constexpr uint32_t kExactSide = 128;
inline constexpr double kLeastHeld = 0.25;  ///< of a light's squared norm

/// `matrix`: rows x columns, row after row. Empty, zero and rank-one matrices are matrices like any other: the rank kept is never above the true one.
Components principalComponents(std::span<const float> matrix, uint32_t rows, uint32_t columns, const ComponentSettings&);

/// What that takes at most, in multiplications with an addition, for `most` vectors: of the smaller Gram matrix with its eigenvectors, or of the range finder.
double decompositionWork(uint32_t rows, uint32_t columns, uint32_t most);

/// Light that is the same everywhere, apart for each group of probes that no receiver of the cluster asks together (two sides of a wall): constant light in one says
/// nothing about the other. Those of most transport first; probes that no receiver asks have none. `matrix` as above, `coefficients` columns a probe, the first of them band 0.
std::vector<std::vector<float>> constantLights(std::span<const float> matrix, uint32_t rows, uint32_t columns, uint32_t coefficients);

}  // namespace hl
