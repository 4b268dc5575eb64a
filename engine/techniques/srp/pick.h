#pragma once
#include <span>

#include "engine/techniques/srp/runtime.h"

namespace hl {

/// The probes that the picked point's receiver asks: what each brings of its irradiance, how large its transport is, and the factors of its weight (probe_factors.h).
PickReport pickReceiver(const SceneView&, Gpu, const ReceiverClusters&, std::span<const ClusterTransport>, const SrpRuntime&, const SrpParams&, const PickedPoint&);

}  // namespace hl
