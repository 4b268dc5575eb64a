#pragma once
// Where probes stand: a lattice over the scene's surfaces, enclosing walls included.
#include "engine/core/math.h"
#include "engine/scene/scene.h"
#include "engine/techniques/ddgi/grid.h"
#include "engine/techniques/ddgi/params.h"

namespace hl {

/// Probes at most, so that both atlases stay within the image size that every device has.
inline constexpr uint32_t kMostProbes = 65536;

/// Fits the lattice into the bounds of all surfaces: the outermost probes lie `inset` spacings inside them, and points between them and the walls ask
/// the nearest cell. At least two probes an axis (one with an inset of 0.5), at most as `count_*` has it. @throws Error(TooLarge) for more probes than
/// kMostProbes or than the atlases have room for, saying what would be right
shared::DdgiGrid fitLattice(const Bounds& surfaces, const DdgiParams&);
uint32_t probeCount(const shared::DdgiGrid&);

/// Mean albedo of the scene's surfaces by area, luminance; textures by their mean. What a bounce leaves of the light in a closed scene.
float meanAlbedo(const Scene&);
/// Frames without history after a reset: bounces until a closed scene of this albedo has all but 0.5 % of its light, at most 64.
uint32_t startFrames(float albedo, const DdgiParams&);
/// Frames from which on a picture counts as settled, after a reset, or after a change that the probes followed: then the exponential average has
/// 1 % left at the scene's albedo, or it is stopped at kMostSettlingFrames (and the picture is as far as it is).
uint32_t settlingFrames(float albedo, const DdgiParams&, bool followed);
inline constexpr uint32_t kMostSettlingFrames = 4096;

}  // namespace hl
