#pragma once
// What a bake takes, counted before a ray is cast.
#include "engine/techniques/radiosity/bake.h"

namespace hl {

/// As the session learns and tells it: direct rays, rays, and gathered samples.
std::vector<WorkPart> bakeWork(const RadiosityBake::Done&);

/// A bake with these parameters on so many lumels: in the first bounce every ray is cast, in later ones those whose hits are not remembered. Bounces are those after
/// which, with the surfaces' mean albedo, `residual` is reached; at most `bounces`.
RebuildEstimate estimateBake(const SceneView&, const RadiosityParams&, double lumels);

}  // namespace hl
