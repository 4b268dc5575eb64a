#pragma once
// Receivers of light from what the rasteriser saw and from a lightmap.
#include <span>
#include <vector>

#include "engine/core/image.h"
#include "engine/lightmap/atlas.h"
#include "engine/reference/reference.h"

namespace hl {

/// One receiver a pixel, from the G-buffer's images of the same names (engine/passes/gbuffer.h). `ids`: two words a pixel, triangle + 1 and material; with
/// `scene` they tell which back faces are two-sided. Without them every back face counts as two-sided.
/// With `eye`, the camera's place, too, those on glossy materials have their lobes. @throws Error(BadInput) where sizes or channels don't fit.
std::vector<Receiver> receiversFromGBuffer(const Image& position, const Image& normal, const Image& geometricNormal,
                                           std::span<const uint32_t> ids = {}, const Scene* scene = nullptr, const vec3* eye = nullptr);

/// One receiver a valid texel, in the atlas's order: the front side, at the centroid.
std::vector<Receiver> receiversFromLumels(const std::vector<Lumel>&);

}  // namespace hl
