// What one of a receiver's probes says of what one of its rays hit: the kernel that every row of the matrix is a sum of. weigh_answers.comp has left its weight.
#include "engine/techniques/srp/probe_frame.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"

layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer questions_block { Ray questions[]; };

/// The corrected direction of a question, in the frame that `toProbe` leads to: from the probe to what the receiver sees; into the open it is the receiver's own.
vec3 askedDirection(uint ray, uint question, vec4 toProbe) {
  vec3 direction = questions[question].direction;
  if (hits[ray].primitive != kMiss) direction = -normalize(direction);
  return rotated(direction, toProbe);
}
