#ifndef HALFLIGHT_DIRECT_BATCH_H
#define HALFLIGHT_DIRECT_BATCH_H
// One batch of direct light: `count` points, each with a ray to every punctual light and `samples` rays to an emitter, to the sky and to the environment map.
#include "shaders/shared/environment.h"
#include "shaders/shared/interop.h"
HL_BEGIN

/// Push constants of the passes. A point's rays are `count` apart: slot k of point i is ray k * count + i. Slots: punctual lights, then for each
/// sample an emitter (where there are any), the sky (where it shines) and the environment map (where there is one).
struct DirectBatch {
  uint pointBase;    ///< of the first point in the buffer of points
  uint targetBase;   ///< of the first point in the buffer of irradiance; its random sequence goes by this index too
  uint count;
  uint seed;
  uint firstSample;  ///< index in each point's sequence
  uint samples;
  uint lights;       ///< punctual lights taken in, 0 or all
  uint emitters;     ///< emissive triangles taken in, 0 or all
  vec3 sky;          ///< radiance; black: not taken in
  uint skyRays;      ///< 1 where the sky is taken in
  uint environmentRays;  ///< 1 where the environment map is taken in
  vec3 eye;          ///< where lobes reflect to; of irradiance unused
  EnvironmentInfo environment;
};

HL_INLINE uint directSlots(DirectBatch b) { return b.lights + b.samples * ((b.emitters > 0u ? 1u : 0u) + b.skyRays + b.environmentRays); }

/// Of lobes: rays to lights, as above but for sky and map; and rays that the lobes choose, which see those, and emitters, where they go.
HL_INLINE uint lobeLightSlots(DirectBatch b) { return b.lights + b.samples * (b.emitters > 0u ? 1u : 0u); }
HL_INLINE uint lobeRaySlots(DirectBatch b) { return b.emitters > 0u || b.skyRays > 0u || b.environmentRays > 0u ? b.samples : 0u; }

HL_END
#endif
