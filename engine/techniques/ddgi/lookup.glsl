#ifndef HALFLIGHT_DDGI_LOOKUP_GLSL
#define HALFLIGHT_DDGI_LOOKUP_GLSL
// What the probes round a point know of the irradiance there (Majercik et al. 2019, section 5.2; 2021).
#include "engine/techniques/ddgi/grid.h"
#include "shaders/shared/octahedral.h"
#include "shaders/shared/params.glsl"
#include "engine/techniques/ddgi/params.inl"
#include "engine/techniques/ddgi/proximity.glsl"
#include "shaders/shared/sampling.h"

uniform samplerBuffer probes;  // position, state
uniform sampler2D irradianceAtlas;
uniform sampler2D distanceAtlas;

/// Where in an atlas of tiles of `texels` with a border a probe's direction lies, from 0 to 1.
vec2 atlasPlace(uint probe, vec3 direction, int texels, vec2 size) {
  const vec2 tile = vec2(probe % grid.tilesAcross, probe / grid.tilesAcross) * float(texels + 2);
  return (tile + 1.0 + (octahedralEncode(direction) * 0.5 + 0.5) * float(texels)) / size;
}

/// [W/m^2]. The atlas holds the mean radiance over the cosine lobe, as its 1/gamma-th power.
vec3 probeIrradiance(uint probe, vec3 normal) {
  vec3 v = textureLod(irradianceAtlas, atlasPlace(probe, normal, ddgi.irradiance_texels, vec2(textureSize(irradianceAtlas, 0))), 0.0).xyz;
  if (ddgi.gamma != 1.0) v = pow(max(v, vec3(0.0)), vec3(ddgi.gamma));
  return kPi * v;
}

/// Bound on the chance that nothing lies between probe and point, to a power (Donnelly and Lauritzen, "Variance Shadow Maps", 2006).
float probeVisibility(uint probe, vec3 fromProbe) {
  const float away = length(fromProbe);
  if (away == 0.0) return 1.0;
  const vec2 moments = textureLod(distanceAtlas, atlasPlace(probe, fromProbe, ddgi.distance_texels, vec2(textureSize(distanceAtlas, 0))), 0.0).xy;
  const float near = proximity(away);
  if (near >= moments.x) return 1.0;
  const float variance = abs(moments.y - moments.x * moments.x), beyond = moments.x - near;
  const float bound = variance / (variance + beyond * beyond);
  return max(ddgi.visibility_floor, pow(bound, ddgi.visibility_power));
}

/// A point that asks, and the cell it asks.
struct Asker {
  vec3 position;
  vec3 normal;    ///< shading
  vec3 biased;
  uvec3 base;     ///< lower corner of the cell
  vec3 fraction;  ///< place in the cell
};

Asker makeAsker(vec3 position, vec3 normal, vec3 geometricNormal, vec3 toViewer) {
  Asker a;
  a.position = position;
  a.normal = normal;
  a.biased = position + (geometricNormal * ddgi.normal_bias + toViewer * ddgi.view_bias) * grid.leastSpacing;
  const vec3 place = clamp((a.biased - grid.first) / grid.spacing, vec3(0.0), vec3(grid.counts - 1u));
  a.base = min(uvec3(place), max(grid.counts, uvec3(2u)) - 2u);
  a.fraction = place - vec3(a.base);
  return a;
}

/// `corner`: 0 to 7. Without irradiance.
DdgiProbeWeight weighProbe(Asker a, uint corner) {
  const uvec3 step = uvec3(corner, corner >> 1, corner >> 2) & 1u;
  DdgiProbeWeight p;
  p.at = min(a.base + step, grid.counts - 1u);
  const vec4 probe = texelFetch(probes, int(probeIndex(p.at, grid.counts)));
  p.position = probe.xyz;
  p.state = uint(probe.w);
  p.irradiance = vec3(0.0);
  const vec3 t = max(vec3(kLeastTrilinear), mix(1.0 - a.fraction, a.fraction, vec3(step)));
  p.trilinear = t.x * t.y * t.z;
  p.facing = 1.0;
  p.visibility = 1.0;
  p.weight = 0.0;
  if (p.state != kProbeActive) return p;
  if (ddgi.facing != 0) {
    const vec3 to = p.position - a.position;
    const float squared = dot(to, to);
    const float wrapped = (squared > 0.0 ? dot(to, a.normal) * inversesqrt(squared) : 0.0) * 0.5 + 0.5;
    p.facing = wrapped * wrapped + kFacingOffset;
  }
  if (ddgi.visibility != 0) p.visibility = probeVisibility(probeIndex(p.at, grid.counts), a.biased - p.position);
  float w = max(kLeastWeight, p.facing * p.visibility);
  if (ddgi.crush != 0 && w < kCrushBelow) w *= w * w / (kCrushBelow * kCrushBelow);
  p.weight = w * p.trilinear;
  return p;
}

/// RGB: irradiance [W/m^2]; w: sum of weights, 0 where no probe round the point is active, and then there is no irradiance.
vec4 cachedIrradiance(vec3 position, vec3 normal, vec3 geometricNormal, vec3 toViewer) {
  const Asker a = makeAsker(position, normal, geometricNormal, toViewer);
  vec4 sum = vec4(0.0);
  for (uint corner = 0u; corner < 8u; ++corner) {
    const DdgiProbeWeight p = weighProbe(a, corner);
    if (p.weight > 0.0) sum += p.weight * vec4(probeIrradiance(probeIndex(p.at, grid.counts), normal), 1.0);
  }
  return sum.w > 0.0 ? vec4(sum.xyz / sum.w, sum.w) : vec4(0.0);
}
#endif
