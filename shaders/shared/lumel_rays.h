#ifndef HALFLIGHT_LUMEL_RAYS_H
#define HALFLIGHT_LUMEL_RAYS_H
// A lumel's rays, and the texels that they hit: written once for shaders and host.
#include "shaders/shared/lightmap_codes.h"
#include "shaders/shared/sampling.h"
HL_BEGIN

HL_CONST float kRayEnd = 1e30f;  ///< [m]: beyond every scene

/// sampleDisc without its range reduction: the angle stays within an eighth of a turn, where these polynomials are good to 4e-8. Rays are
/// made as fast as they are traced only because of this.
HL_INLINE vec2 concentricDisc(vec2 u) {
  float x = 2.0f * u.x - 1.0f;
  float y = 2.0f * u.y - 1.0f;
  bool wide = abs(x) > abs(y);
  float r = wide ? x : y;
  float other = wide ? y : x;
  float a = r == 0.0f ? 0.0f : 0.25f * kPi * other / r;
  float a2 = a * a;
  float s = a * (1.0f + a2 * (-1.6666655e-1f + a2 * (8.3321609e-3f + a2 * -1.9515296e-4f)));
  float c = 1.0f + a2 * (-0.5f + a2 * (4.1666642e-2f + a2 * (-1.3887316e-3f + a2 * 2.4433157e-5f)));
  return vec2(r * (wide ? c : s), r * (wide ? s : c));
}

/// A point of the unit square moved by `shift`, and back in on the other side.
HL_INLINE vec2 shifted(vec2 point, vec2 shift) {
  float x = point.x + shift.x;
  float y = point.y + shift.y;
  return vec2(x >= 1.0f ? x - 1.0f : x, y >= 1.0f ? y - 1.0f : y);
}

/// A point of the unit disc turned by the angle with this cosine and sine.
HL_INLINE vec2 turned(vec2 point, vec2 turn) { return vec2(turn.x * point.x - turn.y * point.y, turn.y * point.x + turn.x * point.y); }

/// Height of the hemisphere over a point of the unit disc.
HL_INLINE float hemisphereHeight(vec2 d) { return sqrt(max(0.0f, 1.0f - d.x * d.x - d.y * d.y)); }

/// From the table of triangles, two entries each: uv of corner 0, edge to 1; edge to 2, normal (octahedral). Its direction, of any length.
HL_INLINE vec3 tableDirection(vec4 second) {
  vec3 n = vec3(second.z, second.w, 1.0f - abs(second.z) - abs(second.w));
  float fold = max(-n.z, 0.0f);
  n.x += n.x >= 0.0f ? -fold : fold;
  n.y += n.y >= 0.0f ? -fold : fold;
  return n;
}
HL_INLINE bool hitsBack(vec4 second, vec3 direction) { return dot(tableDirection(second), direction) >= 0.0f; }
HL_INLINE vec3 tableNormal(vec4 second) { return normalize(tableDirection(second)); }

/// Index in the map from texels to lumels. What is negative rounds to 0 or is cut off there.
HL_INLINE uint texelHit(vec4 first, vec4 second, float u, float v, uint resolution) {
  float size = float(resolution);
  int last = int(resolution) - 1;
  int x = int((first.x + u * first.z + v * second.x) * size);
  int y = int((first.y + u * first.w + v * second.y) * size);
  return uint(clamp(y, 0, last)) * resolution + uint(clamp(x, 0, last));
}

/// From an entry of that map.
HL_INLINE uint codeOfLumel(uint lumel) { return lumel == kNoLumel ? kCodeNoTexel : lumel & ~kBorrowed; }

HL_END
#endif
