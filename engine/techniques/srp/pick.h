#pragma once
#include <span>

#include "engine/techniques/srp/runtime.h"

namespace hl {

/// The probes that the picked point's receiver asks: what each brings of its irradiance, and how large its transport is.
PickReport pickReceiver(const SceneView&, Device&, const ReceiverClusters&, std::span<const ClusterTransport>, const SrpRuntime&, const SrpParams&, const PickedPoint&);

}  // namespace hl
