#pragma once
// Views of where probes stand, for every technique that needs some; and which probe is under a pixel.
#include <optional>
#include <span>
#include <vector>

#include "engine/passes/display.h"
#include "engine/passes/gbuffer.h"

namespace hl {

/// probes, probe_coverage, probe_seen
const std::vector<ViewInfo>& probeViews();
bool isProbeView(const std::string& id);

/// Radius of the balls that stand for probes, as a share of the longest side of the scene's bounds.
inline constexpr float kProbeMarkRadius = 0.012f;
float probeMarkRadius(const Bounds&);

/// The probe whose ball (of `radius` [m]) the ray from the camera meets first, whatever stands between.
std::optional<uint32_t> probeOnRay(std::span<const vec3> probes, const CameraBasis&, vec3 direction, float radius);

}  // namespace hl
