// What one of a receiver's probes says of what one of its rays hit: the kernel that every row of the matrix is a sum of.
#include "engine/techniques/srp/probe_frame.h"
#include "shaders/shared/ray.h"
#include "shaders/shared/spherical_harmonics.h"

layout(scalar) readonly buffer hits_block { Hit hits[]; };
layout(scalar) readonly buffer questions_block { Ray questions[]; };
layout(scalar) readonly buffer shares_block { float shares[]; };
layout(scalar) readonly buffer scales_block { float scales[]; };
layout(scalar) readonly buffer surfaces_block { float surfaces[]; };       // probes x coefficients: which directions end on a surface, in spherical harmonics
layout(push_constant, scalar) uniform Constants { SrpUnit unit; };

/// Of ray r of the unit, the probe in slot q, whose number is `probe` and whose frame `toProbe` leads to: the direction in which it is asked, there, and its weight. False: it says nothing.
bool probeAnswers(uint r, uint q, uint probe, vec4 toProbe, out vec3 local, out float w) {
  local = vec3(0.0, 0.0, 1.0);
  w = 0.0;
  uint question = r * unit.slots + q;
  float scale = scales[r];
  float share = shares[question];
  if (scale <= 0.0 || share == 0.0) return false;
  // The corrected direction: from the probe to what the receiver sees; into the open it is the receiver's own.
  vec3 direction = questions[question].direction;
  if (hits[r].primitive != kMiss) direction = -normalize(direction);
  if (unit.surfaceShare != 0u && hits[r].primitive == kMiss) return false;
  local = rotated(direction, toProbe);
  w = share * scale;
  if (unit.surfaceShare != 0u) {
    float surface = 0.0;
    uint own = probe * uint(shCount(unit.order));
    for (ShWalk y = shBegin(unit.order, local); !shDone(y); shNext(y)) {
      surface += surfaces[own + uint(shIndex(y.l, y.m))] * shValue(y);
      if (y.m > 0) surface += surfaces[own + uint(shIndex(y.l, -y.m))] * shMirroredValue(y);
    }
    w /= max(surface, kSrpLeastSurface);
  }
  return true;
}
