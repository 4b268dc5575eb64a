#ifndef HALFLIGHT_SURFEL_GRID_CELLS_H
#define HALFLIGHT_SURFEL_GRID_CELLS_H
// The camera's grid (after Brinck et al. 2021): a cube of uniform cells round the eye; beyond it six frusta of cells that grow with the distance, so that a surfel
// of constant size on screen reaches as many everywhere; and where surfels have reached their largest radius, uniform cells again, all round. Distances are the
// largest of the three coordinates: in a frustum, along its axis.
#include "shaders/shared/interop.h"
#ifdef __cplusplus
namespace hl::shared {
using glm::log;
}
#endif
HL_BEGIN

HL_CONST uint kGridRegions = 8u;  ///< the cube, the frusta along +x, -x, +y, -y, +z, -z, and what lies beyond
HL_CONST uint kBeyondFrusta = 7u;

/// Cells of a region that the scene's bounds reach; at least one.
struct GridRegion {
  vec3 low;         ///< coordinates of the first cell, whole numbers
  uint firstCell;
  uvec3 size;
};

struct GridShape {
  float inner;      ///< half the cube's edge [m]
  float outer;      ///< where the frusta end [m]; at least inner
  float edge;       ///< of the cube's and the frusta's cells, as a share of the distance (in the cube: of inner)
  float perLog;     ///< 1 / log(1 + edge)
  float outerEdge;  ///< of the cells beyond [m]
};

/// Which region the point `q`, relative to the eye, lies in.
HL_INLINE uint gridRegionOf(vec3 q, GridShape g) {
  vec3 m = abs(q);
  float away = max(m.x, max(m.y, m.z));
  if (away < g.inner) return 0u;
  if (away >= g.outer) return kBeyondFrusta;
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

/// Coordinates in cells.
HL_INLINE vec3 gridCoordinates(vec3 q, uint region, GridShape g) {
  if (region == 0u) return q / (g.edge * g.inner);
  if (region == kBeyondFrusta) return q / g.outerEdge;
  vec3 t = gridTurned(q, region);
  float along = max(t.x, g.inner);
  return vec3(log(along / g.inner) * g.perLog, t.y / (along * g.edge), t.z / (along * g.edge));
}

/// Coordinates in cells that a box of half sizes `extent` round `q` reaches in a region; false: it does not reach the region.
HL_INLINE bool gridReach(vec3 q, vec3 extent, uint region, GridShape g, HL_OUT(vec3) low, HL_OUT(vec3) high) {
  const float slack = 1e-4f;  // in cells: what rounding may shift
  low = vec3(0.0f);
  high = vec3(0.0f);
  if (region == 0u || region == kBeyondFrusta) {
    vec3 a = q - extent;
    vec3 b = q + extent;
    vec3 farthest = max(abs(a), abs(b));
    if (region == 0u && (max(a.x, max(a.y, a.z)) > g.inner || min(b.x, min(b.y, b.z)) < -g.inner)) return false;
    if (region != 0u && max(farthest.x, max(farthest.y, farthest.z)) < g.outer) return false;
    float edge = region == 0u ? g.edge * g.inner : g.outerEdge;
    low = a / edge - vec3(slack);
    high = b / edge + vec3(slack);
    return true;
  }
  vec3 t = gridTurned(q, region);
  vec3 e = abs(gridTurned(extent, region));
  float far = min(t.x + e.x, g.outer);
  float near = max(t.x - e.x, g.inner);
  if (far < g.inner || near > g.outer) return false;
  vec2 a = vec2(t.y - e.y, t.z - e.z);
  vec2 b = vec2(t.y + e.y, t.z + e.z);
  a = vec2(a.x / (a.x < 0.0f ? near : far), a.y / (a.y < 0.0f ? near : far));
  b = vec2(b.x / (b.x < 0.0f ? far : near), b.y / (b.y < 0.0f ? far : near));
  if (max(a.x, a.y) > 1.0f + slack || min(b.x, b.y) < -1.0f - slack) return false;
  a = clamp(a, vec2(-1.0f), vec2(1.0f)) / g.edge;
  b = clamp(b, vec2(-1.0f), vec2(1.0f)) / g.edge;
  low = vec3(log(near / g.inner) * g.perLog - slack, a.x - slack, a.y - slack);
  high = vec3(log(far / g.inner) * g.perLog + slack, b.x + slack, b.y + slack);
  return true;
}

HL_END
#endif
