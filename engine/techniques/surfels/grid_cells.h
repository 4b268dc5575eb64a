#ifndef HALFLIGHT_SURFEL_GRID_CELLS_H
#define HALFLIGHT_SURFEL_GRID_CELLS_H
// The camera's grid (after Brinck et al. 2021): a cube of uniform cells round the eye, and beyond it six frusta of cells that grow with the distance, so that
// a surfel of constant size on screen reaches as many everywhere. Distances are along the frustum's axis: the largest of the three coordinates.
#include "shaders/shared/interop.h"
#ifdef __cplusplus
namespace hl::shared {
using glm::log;
}
#endif
HL_BEGIN

HL_CONST uint kGridRegions = 7u;  ///< the cube, then the frusta along +x, -x, +y, -y, +z, -z

/// Cells of a region that the scene's bounds reach; at least one.
struct GridRegion {
  vec3 low;         ///< coordinates of the first cell, whole numbers
  uint firstCell;
  uvec3 size;
};

/// Which region the point `q`, relative to the eye, lies in. `inner`: half the cube's edge.
HL_INLINE uint gridRegionOf(vec3 q, float inner) {
  vec3 m = abs(q);
  if (max(m.x, max(m.y, m.z)) < inner) return 0u;
  if (m.x >= m.y && m.x >= m.z) return q.x > 0.0f ? 1u : 2u;
  if (m.y >= m.z) return q.y > 0.0f ? 3u : 4u;
  return q.z > 0.0f ? 5u : 6u;
}

/// `q` along the region's axis, then across it.
HL_INLINE vec3 gridTurned(vec3 q, uint region) {
  if (region <= 2u) return vec3(region == 1u ? q.x : -q.x, q.y, q.z);
  if (region <= 4u) return vec3(region == 3u ? q.y : -q.y, q.z, q.x);
  return vec3(region == 5u ? q.z : -q.z, q.x, q.y);
}

/// Coordinates in cells. `edge`: of a cell, as a share of its distance; `perLog` = 1 / log(1 + edge).
HL_INLINE vec3 gridCoordinates(vec3 q, uint region, float inner, float edge, float perLog) {
  if (region == 0u) return q / (edge * inner);
  vec3 t = gridTurned(q, region);
  float along = max(t.x, inner);
  return vec3(log(along / inner) * perLog, t.y / (along * edge), t.z / (along * edge));
}

/// Coordinates in cells that a box of half sizes `extent` round `q` reaches in a region; false: it does not reach the region.
HL_INLINE bool gridReach(vec3 q, vec3 extent, uint region, float inner, float edge, float perLog, HL_OUT(vec3) low, HL_OUT(vec3) high) {
  const float slack = 1e-4f;  // in cells: what rounding may shift
  low = vec3(0.0f);
  high = vec3(0.0f);
  if (region == 0u) {
    vec3 a = q - extent;
    vec3 b = q + extent;
    if (max(a.x, max(a.y, a.z)) > inner || min(b.x, min(b.y, b.z)) < -inner) return false;
    low = a / (edge * inner) - vec3(slack);
    high = b / (edge * inner) + vec3(slack);
    return true;
  }
  vec3 t = gridTurned(q, region);
  vec3 e = abs(gridTurned(extent, region));
  float far = t.x + e.x;
  if (far < inner) return false;
  float near = max(t.x - e.x, inner);
  vec2 a = vec2(t.y - e.y, t.z - e.z);
  vec2 b = vec2(t.y + e.y, t.z + e.z);
  a = vec2(a.x / (a.x < 0.0f ? near : far), a.y / (a.y < 0.0f ? near : far));
  b = vec2(b.x / (b.x < 0.0f ? far : near), b.y / (b.y < 0.0f ? far : near));
  if (max(a.x, a.y) > 1.0f + slack || min(b.x, b.y) < -1.0f - slack) return false;
  a = clamp(a, vec2(-1.0f), vec2(1.0f)) / edge;
  b = clamp(b, vec2(-1.0f), vec2(1.0f)) / edge;
  low = vec3(log(near / inner) * perLog - slack, a.x - slack, a.y - slack);
  high = vec3(log(far / inner) * perLog + slack, b.x + slack, b.y + slack);
  return true;
}

HL_END
#endif
