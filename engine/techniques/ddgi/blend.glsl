// A frame's rays into one probe's tile of an atlas, border included: one workgroup a probe. The includer defines HL_DDGI_DISTANCE, or not.
#include "engine/techniques/ddgi/grid.h"
#include "shaders/shared/octahedral.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/ddgi/params.inl"
#include "shaders/shared/ray.h"

layout(local_size_x = 64) in;

#ifdef HL_DDGI_DISTANCE
#define VALUE vec2
#define AGES_ACCESS readonly
layout(rg32f) readonly uniform image2D before;
layout(rg32f) writeonly uniform image2D after;
#else
#define VALUE vec3
#define AGES_ACCESS
layout(rgba32f) readonly uniform image2D before;
layout(rgba32f) writeonly uniform image2D after;
#endif

#include "engine/techniques/ddgi/proximity.glsl"
layout(scalar) readonly buffer rays_block { Ray rays[]; };
layout(scalar) readonly buffer radiance_block { vec4 radiance[]; };
layout(scalar) readonly buffer probes_block { vec4 probes[]; };
layout(scalar) AGES_ACCESS buffer ages_block { uint ages[]; };  // frames that a probe has gathered
layout(scalar) buffer counters_block { uint counters[]; };
layout(push_constant, scalar) uniform Constants { DdgiBatch batch; };

const uint kMostTexels = 28u;
const uint kChunk = 64u;
shared VALUE tile[kMostTexels * kMostTexels];
shared vec3 directions[kChunk];
#ifdef HL_DDGI_DISTANCE
shared float values[kChunk];
#else
shared vec3 values[kChunk];
#endif

/// The interior texel that a border's texel repeats: across the edge the octahedron goes on mirrored.
ivec2 inside(ivec2 at, int texels) {
  const bvec2 border = bvec2(at.x == 0 || at.x == texels + 1, at.y == 0 || at.y == texels + 1);
  const ivec2 nearest = clamp(at, ivec2(1), ivec2(texels)), mirrored = texels + 1 - at;
  if (border.x && border.y) return texels + 1 - nearest;
  if (border.x) return ivec2(nearest.x, mirrored.y);
  if (border.y) return ivec2(mirrored.x, nearest.y);
  return at;
}

bool anyNan(VALUE v) { return any(isnan(v)); }
bool anyInf(VALUE v) { return any(isinf(v)); }
