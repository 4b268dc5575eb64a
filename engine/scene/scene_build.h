#pragma once
// The steps that every scene goes through after its geometry, materials and lights are there.
#include <cmath>
#include <string>

#include "engine/scene/scene.h"
#include "engine/scene/scene_file.h"

namespace hl {

/// A scene whose centre lies further from the origin than this many of its diagonals is moved there: a float then keeps
/// 2e-6 of the diagonal or better, which is what ray offsets need.
inline constexpr float kRecentreDistance = 32;

/// Hash of all that light transport depends on: geometry, materials, textures, lights, sky. Names and cameras are left
/// out.
std::string sceneContentHash(const Scene&);

/// Moves surfaces, lights and cameras of a scene that lies far from the origin; adds the shift to report.recentred.
void recentreScene(Scene&);

/// Bounds, albedo cap, recentring, a camera where there is none, and the hash.
void finishScene(Scene&);

}  // namespace hl
