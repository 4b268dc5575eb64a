#pragma once
// Irradiance as a function of the normal, for receivers that know more than one (Silvennoinen and Lehtinen 2017 call them directional).
#include <vector>

#include "engine/core/math.h"
#include "engine/gpu/device.h"
#include "engine/techniques/srp/params.h"

namespace hl {

/// Entries of the table, over the cosine between a sample's direction and the receiver's normal, 0 to 1.
inline constexpr int kDirectionalEntries = 65;

/// What unit radiance from a direction w adds to the irradiance of a tilted normal n, max(0, w.n), as w.n0 + b.(n - n0): exact at the receiver's own normal n0, and nearest in
/// the mean over the normals within 60 degrees of it (uniform in solid angle). Entry i is for w.n0 = i / (entries - 1): x is b's part along w's projection on the surface, y
/// its part along n0. Where no normal of the cone turns away from w these are w's own.
std::vector<vec2> directionalTable();
/// It on the device, as directional.glsl reads it; where receivers are not directional, something in its place that nothing reads.
Buffer directionalBuffer(Device&, const SrpParams&);

}  // namespace hl
