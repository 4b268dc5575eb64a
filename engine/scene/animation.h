#pragma once
// Animations at a moment. Everything here is a function of the scene and the time alone.
#include <span>
#include <vector>

#include "engine/scene/scene.h"

namespace hl {

/// Longest time a key may have, and so the longest run of an animation [s].
inline constexpr float kLongestAnimation = 1e5f;

/// Where in its keys, which run from 0 to `duration`, an animation is at `time`.
double timeWithin(Repeat, double duration, double time);

/// Rest pose to world of what the animation moves.
mat4 poseAt(const ObjectAnimation&, double time);
/// One an object of the scene: the product of the animations that name it, in their order; the identity for the rest.
std::vector<mat4> posesAt(const Scene&, double time);
/// What the keys say between them, direction unit.
LightKey lightAt(const LightAnimation&, double time);
Camera cameraAt(const CameraPath&, double time);

/// Whether objects or lights move at some time.
bool animated(const Scene&);
/// Bounds of the objects that `poses` leaves where they are or puts elsewhere, over all times: their boxes at 64 moments of each animation that moves them and
/// at its keys. Between these a box may reach further by what a turn of 1/64 of the animation adds.
Bounds boundsOfPoses(const Scene& atRest);

/// @throws Error(BadInput) for a path without a name of its own, without keys, or whose times do not ascend from 0.
void checkCameraPaths(const std::vector<CameraPath>&);
/// The scene's path of that name. @throws Error(BadInput) naming those there are.
const CameraPath& cameraPath(const Scene&, const std::string& name);

}  // namespace hl
