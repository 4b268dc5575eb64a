#pragma once
#include <cstdint>
#include <vector>

#include "engine/techniques/srp/unit.h"

namespace hl {

/// The transport of one cluster, compressed or not.
struct ClusterTransport {
  uint32_t receivers = 0, wide = 0, rows = 1, columns = 0, rank = 0;  ///< the first receivers, `wide` of them, have `rows` each, the others one
  std::vector<float> basis;      ///< rank x columns; empty without compression, where rank is columns
  std::vector<float> weights;    ///< allRows() x rank: irradiance, and what else rows stand for (unit.h), is the weights times the cluster's light vector
  std::vector<float> valid;      ///< one a receiver: share of its samples that some probe can speak for
  std::vector<uint32_t> readsOf; ///< one a receiver: how many of `reads` are its own, which follow those of the receivers before it; empty where nothing is read
  std::vector<shared::SrpRead> reads;  ///< lumels that stand for what no probe sees
  uint32_t allRows() const { return receivers + (rows - 1) * wide; }
  double coarse = 0, scarce = 0;    ///< samples of all its receivers: read off the lightmap since all probes blur them too much; answered by a probe that sees less surface there than kSrpLeastSurface
  double total = 0, discarded = 0;  ///< squared Frobenius norms: of the transport, of what compression left out
};

}  // namespace hl
