// A sample's factors in the rows of a directional receiver, over its factor in the irradiance's own row: the parts of irradiance's change with the normal, in the frame
// that orthonormalBasis gives for `normal`.
#include "shaders/shared/sampling.h"

layout(scalar) readonly buffer directional_block { vec2 directional[]; };   // directionalTable()

vec3 directionalFactors(vec3 direction, vec3 normal) {
  vec3 t, b;
  orthonormalBasis(normal, t, b);
  vec3 w = vec3(dot(direction, t), dot(direction, b), dot(direction, normal));
  // The samples' density is their height, which is divided out; of those that graze the surface no single one may decide.
  float height = clamp(w.z, 1e-3, 1.0);
  float at = height * float(directional.length() - 1);
  uint low = min(uint(at), uint(directional.length()) - 2u);
  vec2 slope = mix(directional[low], directional[low + 1u], at - float(low)) / height;
  float across = length(w.xy);
  return vec3(across > 0.0 ? slope.x / across * w.xy : vec2(0.0), slope.y);
}
