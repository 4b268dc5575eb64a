// A sample's factors in the rows of a directional receiver, over its factor in the irradiance's own row: the parts of irradiance's change with the normal, in the frame
// that orthonormalBasis gives for `normal`.
#include "shaders/shared/sampling.h"

layout(scalar) readonly buffer directional_block { vec2 directional[]; };   // directionalTable()

/// Samples are cosine distributed, so their density, which is divided out, is their height over the surface. `least`: what counts as that at least, so that no
/// single sample that grazes the surface decides; of N stratified ones the lowest is at 1 / sqrt(N).
vec3 directionalFactors(vec3 direction, vec3 normal, float least) {
  vec3 t, b;
  orthonormalBasis(normal, t, b);
  vec3 w = vec3(dot(direction, t), dot(direction, b), dot(direction, normal));
  float height = clamp(w.z, least, 1.0);
  float at = height * float(directional.length() - 1);
  uint low = min(uint(at), uint(directional.length()) - 2u);
  vec2 slope = mix(directional[low], directional[low + 1u], at - float(low)) / height;
  float across = length(w.xy);
  return vec3(across > 0.0 ? slope.x / across * w.xy : vec2(0.0), slope.y);
}
