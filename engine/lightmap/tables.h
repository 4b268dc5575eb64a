#pragma once
// The atlas in the form that shaders read.
#include <cstdint>
#include <vector>

#include "engine/core/progress.h"
#include "engine/lightmap/atlas.h"
#include "engine/scene/scene.h"
#include "shaders/shared/surface_point.h"

namespace hl {

struct LightmapTables {
  std::vector<vec4> reflectance;         ///< one a lumel: albedo / pi; w: area [m^2]
  std::vector<vec4> triangles;           ///< two a triangle: uv of corner 0, edge to 1; edge to 2, normal (octahedral)
  std::vector<uint32_t> lumelOfTexel;    ///< index, with kBorrowed where the texel has none of its own; kNoLumel beyond kBorrowReach
  std::vector<uint32_t> chartOfTexel;    ///< of the texel's lumel; through dilation that of the one chart next to it, kMixedChart between two
};

/// How far a hit may look for a lumel of its chart, where its own texel is invalid (under an object's edge) or missed by rounding [texels].
inline constexpr int kBorrowReach = 2;

/// `dilation` [texels]: rings of labels in chartOfTexel.
LightmapTables makeLightmapTables(const Scene&, const Atlas&, int dilation, Progress&);

/// Where lumels' rays start: `offset` [m] in front of the surface.
std::vector<shared::SurfacePoint> lumelPoints(const Atlas&, float offset);

}  // namespace hl
