#pragma once
// The lightmap atlas (DESIGN.md section 7): where each surface point's texel is, and what each texel covers. Host data only.
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/scene/scene.h"

namespace hl {

struct AtlasSettings {
  int resolution = 256;                 ///< texels a side
  float uvOverlapTolerance = 0.001f;    ///< share of covered texels that may be claimed twice before own charts are made
  int margin = 2;                       ///< texels kept free round each chart
};

/// A texel with any covered area, one-sided: the front of the surface. Its texel index is y * resolution + x, row 0 at v = 0.
struct Lumel {
  vec3 position{0.0f};   ///< centroid of the covered part, as far as it is in the open (world)
  vec3 normal{0.0f};     ///< geometric normal at the centroid's triangle, unit
  float area = 0;        ///< exact covered world area [m^2]: triangles clipped to the texel; of one opened, the open share of it
  uint32_t texel = 0;
  uint32_t triangle = 0; ///< the triangle that covers the centroid (or the largest part)
  vec3 albedo{0.0f};     ///< area-weighted mean, textures included
  vec3 emission{0.0f};
};

struct AtlasReport {
  bool ownCharts = false;        ///< false: the mesh's UV set serves
  uint32_t charts = 0;
  int margin = 0;                ///< texels kept free round own charts: less than asked where that cost too much density
  uint64_t droppedCharts = 0;    ///< own charts for which no texel was left (the resolution is too small)
  uint64_t coveredTexels = 0, validTexels = 0, overlappingTexels = 0, insideTexels = 0;
  uint64_t openedTexels = 0;     ///< valid ones with the centroid inside other geometry and a part in the open
  double coverage = 0;           ///< covered / all
  double densityMean = 0, densitySpread = 0;  ///< texels per metre: mean and relative standard deviation over triangles
  double area = 0, uncoveredArea = 0;         ///< world area [m^2]: of the scene; of triangles that reach no texel
};

struct Atlas {
  int resolution = 0;
  std::vector<vec2> cornerUvs;        ///< 3 a triangle, in [0, 1]; corner c of triangle t at 3 t + c
  std::vector<uint32_t> charts;       ///< one a triangle: triangles joined in the lightmap; a look-up must not mix texels of two charts
  std::vector<Lumel> lumels;          ///< valid texels only, in texel order
  std::vector<uint32_t> lumelOfTexel; ///< resolution^2: index into lumels, or kNone
  std::vector<uint8_t> texelState;    ///< resolution^2: TexelState, for the validity view
  AtlasReport report;
};
enum TexelState : uint8_t { TexelEmpty = 0, TexelValid = 1, TexelInside = 2, TexelOverlap = 3 };

/// Tells of each lumel whether a point just in front of it lies inside other geometry: 1, or 0.
using FindInside = std::function<void(const std::vector<Lumel>&, std::vector<uint8_t>& inside)>;

/// Texels that `findInside` (may be empty) finds covered are marked TexelInside and left out; those covered in part keep the part in the open.
Atlas buildAtlas(const Scene&, const AtlasSettings&, TaskPool&, Progress&, const FindInside& findInside = {});

}  // namespace hl
