#pragma once
// Moving the camera: orbit, pan, dolly, look round, fly, focus. Pure functions of a camera; no widget.
#include "engine/scene/scene.h"

namespace hl::ui {

class CameraController {
 public:
  const Camera& camera() const { return camera_; }
  void set(const Camera& c) { camera_ = c; }
  /// The scene's diagonal [m]: speeds follow from it.
  void setSceneSize(float diagonal);

  void orbit(float yaw, float pitch);       ///< round the target [rad]
  void look(float yaw, float pitch);        ///< the target goes round the eye [rad]
  void pan(float right, float up);          ///< by shares of the picture's height, at the target's distance
  void dolly(float notches);                ///< towards the target, never through it
  void fly(vec3 direction, float seconds);  ///< right, up, forward; each from -1 to 1
  void focus(vec3 point);                   ///< looks at it and orbits round it from now on

  float flySpeed() const { return speed_ * size_; }  ///< [m/s]
  void changeSpeed(float factor);

 private:
  Camera camera_;
  float size_ = 10, speed_ = 0.25f;
};

}  // namespace hl::ui
