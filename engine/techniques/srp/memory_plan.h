#pragma once
// What a precomputation works in and what its frames hold, counted from its clusters before anything is allocated or cast.
#include <cstddef>
#include <cstdint>

#include "engine/techniques/srp/clusters.h"

namespace hl {

/// Rows of transport that a wide receiver has: of directional receivers all are, of radiance receivers those on glossy surfaces.
uint32_t rowsOf(const SrpParams&);
uint32_t allRows(const ReceiverCluster&, const SrpParams&);
/// Lumels that a receiver reads at most.
uint32_t readsOf(const SrpParams&);

/// What the plan needs to know of the machine.
struct MemoryLimits {
  uint64_t largestBuffer = 0;  ///< [bytes]
  bool cpu = false;            ///< a CPU device
  unsigned threads = 1;        ///< for decompositions
};

/// Entries of the buffers that a precomputation works in, each at least 1: of its largest cluster where they are filled anew for each.
struct WorkingMemory {
  uint64_t points = 1, probes = 1;                  ///< of all clusters
  uint64_t surfaces = 1;                            ///< SrpParams::surface_share: coefficients of all probes
  uint64_t matrix = 1, near = 1, receivers = 1;
  uint64_t strata = 1;                              ///< lumels to be read
  uint64_t moments = 1;                             ///< radiance receivers: sums of factors
  uint64_t slopes = 1;                              ///< directional receivers: of irradiance, by height
  uint64_t questions = 1;                           ///< rays of a unit to probes, and from receivers, at most
  size_t decompositions = 1;                        ///< at once; 0: none beside the rays
  uint64_t bytes() const;                           ///< on the device
};

/// As much as SrpParams::precompute_memory_mb allows. @throws Error(BadInput) where that is too little, Error(TooLarge) where the device's buffers are too small, saying what would fit
WorkingMemory planWorkingMemory(const ReceiverClusters&, const SrpParams&, uint64_t probes, const MemoryLimits&);

/// What frames hold of what radiance receivers receive (SrpRuntime::incident) [bytes]; 0 where there are none.
uint64_t incidentBytes(const ReceiverClusters&, const SrpParams&);

/// What frames need and can be known from clusters. @throws Error(TooLarge) naming what does not fit, and what would
void checkFrameMemory(const ReceiverClusters&, const SrpParams&, const MemoryLimits&);

}  // namespace hl
