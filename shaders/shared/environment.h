#ifndef HALFLIGHT_ENVIRONMENT_H
#define HALFLIGHT_ENVIRONMENT_H
// Equirectangular environment maps: where a direction is in the map, and the other way round. The top row is up (+Y), the middle column straight ahead (-Z), columns go
// to the right (+X). Each texel is a patch of one radiance: what is seen, what is sampled and its density are then the same to the last figure.
#include "shaders/shared/interop.h"
HL_BEGIN

HL_CONST float kEnvironmentPi = 3.14159265358979323846f;

/// What shaders know of a map beside its texels.
struct EnvironmentInfo {
  uint width;   ///< 0: there is none
  uint height;
  float turn;   ///< in turns, clockwise seen from above
  float power;  ///< integral of luminance over all directions: the normaliser of the density
};

/// In [0, 1]^2, from the top left corner. `direction` need not be unit.
HL_INLINE vec2 environmentUv(vec3 direction, float turn) {
  float across = direction.x == 0.0f && direction.z == 0.0f ? 0.0f : atan(direction.x, -direction.z) / (2.0f * kEnvironmentPi);
  float level = sqrt(direction.x * direction.x + direction.z * direction.z);
  return vec2(fract(0.5f + across - turn), clamp(atan(level, direction.y) / kEnvironmentPi, 0.0f, 1.0f));
}

HL_INLINE uint environmentTexel(EnvironmentInfo map, vec3 direction) {
  vec2 uv = environmentUv(direction, map.turn);
  return min(uint(uv.y * float(map.height)), map.height - 1u) * map.width + min(uint(uv.x * float(map.width)), map.width - 1u);
}

/// A direction in texel (column, row), uniform in solid angle for uniform `u`.
HL_INLINE vec3 environmentDirection(EnvironmentInfo map, uint column, uint row, vec2 u) {
  float angle = 2.0f * kEnvironmentPi * ((float(column) + u.x) / float(map.width) - 0.5f + map.turn);
  float top = cos(kEnvironmentPi * float(row) / float(map.height)), bottom = cos(kEnvironmentPi * float(row + 1u) / float(map.height));
  float y = mix(top, bottom, u.y);
  float level = sqrt(max(0.0f, 1.0f - y * y));
  return vec3(level * sin(angle), y, -level * cos(angle));
}

HL_END
#endif
