#pragma once
// A weighted mean over pixels and its standard error, with blocks of pixels as the sample: neighbours' errors are not
// independent.
#include <cstddef>
#include <vector>

namespace hl {

struct BlockMean {
  double mean = 0, standardError = 0;
};

/// `values` and `weights` hold width * height entries; some weight is positive. Blocks are squares of 16 pixels, halved
/// until at least kFewestBlocks of them have weight; the error is that of a ratio of sums over blocks. One block alone:
/// an infinite error.
BlockMean blockMean(const std::vector<double>& values, const std::vector<double>& weights, int width, int height);

/// Standard error of the weighted mean of values whose noise `noise` has been measured: each entry is one draw of it, with mean 0 and the noise's
/// own variance. Drawn together within a block of kBlockEdge, so that neighbours may share theirs.
double blockNoise(const std::vector<double>& noise, const std::vector<double>& weights, int width, int height);

inline constexpr int kBlockEdge = 16;
inline constexpr size_t kFewestBlocks = 16;

}  // namespace hl
