#ifndef HALFLIGHT_DDGI_PROXIMITY_GLSL
#define HALFLIGHT_DDGI_PROXIMITY_GLSL
// What maps of distance average. The includer has included grid.h and params.inl.

layout(scalar) uniform grid_block { DdgiGrid grid; };

const float kNothing = 1e30;  // [m], of a ray that meets no surface

/// How near something is at `t` [m]: a decreasing function, so that Chebyshev's bound on distances holds for it as well. Reciprocals [1/m] are linear in
/// the direction where the surface is a plane, and hardly mind how far those rays go that miss its edge; plain distances are mostly theirs.
float proximity(float t) {
  return ddgi.visibility_moments == kMomentsPlain ? -min(t, grid.farthest) : 1.0 / (t + kProximityOffset * grid.leastSpacing);
}

/// Its inverse [m].
float distanceOf(float near) { return ddgi.visibility_moments == kMomentsPlain ? -near : 1.0 / max(near, 1e-30) - kProximityOffset * grid.leastSpacing; }
#endif
