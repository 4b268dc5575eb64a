#pragma once
// Clusters' matrices on their way to what is kept: compressed beside the rays of the clusters after them, kept and stored in order.
#include <deque>
#include <exception>
#include <future>
#include <memory>
#include <vector>

#include "engine/techniques/srp/cluster_transport.h"
#include "engine/techniques/srp/params.h"
#include "engine/techniques/srp/store.h"

namespace hl {

/// A cluster's sums as they come from the device.
struct ClusterSums {
  uint32_t receivers = 0, wide = 0, rows = 1, columns = 0, coefficients = 1;  ///< rows: a wide receiver, of which there are the first `wide`; coefficients: columns a probe
  std::vector<float> matrix;   ///< all rows (unit.h) x columns: sums of the kernel over samples
  std::vector<float> valid;    ///< one a receiver: samples that some probe speaks for, or that are dark
  std::vector<shared::SrpStratum> strata = {};  ///< sample_weight surface: receivers x so many
  std::vector<float> moments = {};              ///< receivers radiance: wide receivers x (rows - 1): sums of factors (hemisphere_basis.h) over those samples that count
  double coarse = 0, scarce = 0;                ///< ClusterTransport's
  std::vector<float> answered = {};             ///< ... one a receiver: samples that no probe sees and that are known all the same
};

class Compressor {
 public:
  /// `most`: clusters in work at once, on threads of their own; 0: none is, add() does it. `store` may be empty: where it can't be written, that is a warning and no more. `finished`: those that are there already.
  Compressor(const SrpParams&, uint32_t seed, size_t most, std::shared_ptr<TransportStore>, std::vector<ClusterTransport> finished);
  ~Compressor();

  /// Waits where `most` are in work. An exception of one before comes through, now and at each further call.
  void add(ClusterSums);
  /// Waits for all.
  void drain();
  const std::vector<ClusterTransport>& finished() const { return finished_; }

 private:
  void takeFirst();

  SrpParams params_;
  uint32_t seed_;
  size_t most_;
  std::shared_ptr<TransportStore> store_;
  std::vector<ClusterTransport> finished_;
  std::deque<std::future<ClusterTransport>> inWork_;
  std::exception_ptr failed_;
};

/// Sums to means, and those to what is kept. A function of its arguments alone.
ClusterTransport compressCluster(ClusterSums, const SrpParams&, uint32_t seed);

}  // namespace hl
