#pragma once
// What a precomputation takes, counted from its clusters before a ray is cast.
#include "engine/techniques/srp/clusters.h"
#include "engine/techniques/technique.h"

namespace hl {

/// Work in clusters [first, last), all of their samples. A cluster of m receivers and at most q probes a receiver: m samples rays and m samples q
/// questions, as many times `coefficients` and rows a receiver sums, and what the decomposition of its matrix takes in multiplications.
std::vector<WorkPart> transportWork(const ReceiverClusters&, size_t first, size_t last, const SrpParams&, uint32_t coefficients);

/// Rays of probes, which are cast anew each time.
WorkPart probeRayWork(double rays);
/// So many probes' share of surfaces, in harmonics.
WorkPart surfaceShareWork(double probes, const SrpParams&, uint32_t coefficients);

/// Of all of it with these parameters: clusters are made, those on disk need no work. Exact while `lumels` is what the atlas has; else in proportion. Lumels to be read come out of the rays, so of them the most that there can be.
/// @throws Error(BadInput), Error(TooLarge) where Precomputation would for want of memory, as far as that is known (the lightmap is that of the atlas); Error(Cancelled)
RebuildEstimate estimateTransport(const Device&, const SceneView&, const SrpParams&, double lumels, Progress&);

}  // namespace hl
