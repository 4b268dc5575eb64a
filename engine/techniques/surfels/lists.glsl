#ifndef HALFLIGHT_SURFEL_LISTS_GLSL
#define HALFLIGHT_SURFEL_LISTS_GLSL
// Which lists a surfel belongs to: cells of the grid that its ellipsoid reaches, and tiles of the screen with pixels that it may light. Counting and filling
// go through here alike. Before the include a shader declares void visit(uint list, uint id).
layout(constant_id = 11) const bool kSplat = false;

layout(scalar) readonly buffer tile_depths { vec2 tileDepths[]; };

/// Half the length of a surfel's ellipsoid along `direction` (of any length), times that length.
float reachAlong(vec3 direction, vec3 normal, float radius) {
  const float flatness = 1.0 / surfels.normal_squash, along = dot(direction, normal);
  return radius * sqrt(max(0.0, dot(direction, direction) - along * along * (1.0 - flatness * flatness)));
}

void visitBox(vec3 low, vec3 high, GridRegion r, uint id) {
  const uvec3 a = cellWithin(low - r.low, r.size), b = cellWithin(high - r.low, r.size);
  for (uint z = a.z; z <= b.z; ++z)
    for (uint y = a.y; y <= b.y; ++y)
      for (uint x = a.x; x <= b.x; ++x) visit(r.firstCell + cellIndex(uvec3(x, y, z), r.size), id);
}

void visitCells(vec3 position, vec3 normal, float radius, uint id) {
  const vec3 extent = vec3(reachAlong(vec3(1, 0, 0), normal, radius), reachAlong(vec3(0, 1, 0), normal, radius), reachAlong(vec3(0, 0, 1), normal, radius));
  if (!kCameraGrid) {
    const vec3 p = position - frame.gridOrigin;
    visitBox((p - extent) / frame.cellSize, (p + extent) / frame.cellSize, GridRegion(vec3(0.0), 0u, frame.gridSize), id);
    return;
  }
  for (uint region = 0u; region < kGridRegions; ++region) {
    vec3 low, high;
    if (gridReach(position - frame.eye, extent, region, frame.grid, low, high))
      visitBox(low, high, frame.regions[region], id);
  }
}

/// Pixels along one axis that what lies from `a` to `b` across and from `near` to `far` away may cover.
vec2 pixelSpan(float a, float b, float near, float far, uint pixels) {
  const vec2 clip = vec2(a / (a < 0.0 ? near : far), b / (b < 0.0 ? far : near));
  return (0.5 * clip + 0.5) * float(pixels) + vec2(-0.01, 0.01);
}

void visitTiles(vec3 position, vec3 normal, float radius, uint id) {
  const vec3 to = position - frame.eye;
  const float away = dot(to, frame.forward), deep = reachAlong(frame.forward, normal, radius);
  const float near = away - deep, far = away + deep;
  if (far <= 0.0) return;
  vec2 x = vec2(0.0, float(frame.width)), y = vec2(0.0, float(frame.height));
  if (near > 1e-6 * frame.diagonal) {
    const float right = dot(to, frame.right), down = dot(to, frame.down);
    const float wide = reachAlong(frame.right, normal, radius), high = reachAlong(frame.down, normal, radius);
    x = pixelSpan(right - wide, right + wide, near, far, frame.width);
    y = pixelSpan(down - high, down + high, near, far, frame.height);
  }
  const uvec2 tiles = (uvec2(frame.width, frame.height) + kSplatPixels - 1u) / kSplatPixels;
  if (x.y < 0.0 || y.y < 0.0 || x.x > float(frame.width) || y.x > float(frame.height)) return;
  const uvec2 a = min(uvec2(max(vec2(x.x, y.x), vec2(0.0))) / kSplatPixels, tiles - 1u);
  const uvec2 b = min(uvec2(min(vec2(x.y, y.y), vec2(frame.width, frame.height))) / kSplatPixels, tiles - 1u);
  for (uint row = a.y; row <= b.y; ++row)
    for (uint column = a.x; column <= b.x; ++column) {
      const uint tile = row * tiles.x + column;
      const vec2 depths = tileDepths[tile];
      if (near <= depths.y && far >= depths.x) visit(frame.cells + tile, id);
    }
}

/// `signedRadius` as in the records.
void visitLists(vec3 position, vec3 normal, float signedRadius, uint id) {
  visitCells(position, normal, reachOf(signedRadius), id);
  if (kSplat) visitTiles(position, normal, abs(signedRadius), id);
}
#endif
