#include "ui/camera_controller.h"

#include <algorithm>
#include <cmath>

namespace hl::ui {
namespace {

constexpr float kSteepest = 1.55f;       // rad from the horizon; at the zenith the up vector has no meaning
constexpr float kNearest = 1e-3f;        // of the scene's diagonal: the least distance to the target
constexpr float kDollyNotch = 0.88f;     // distance left after one notch

/// Spherical angles of `v` about the up axis: yaw round it, pitch above its plane.
struct Angles {
  float yaw = 0, pitch = 0;
};

struct Frame {
  vec3 right, up, back;  // of the world as the camera's up vector has it
};

Frame worldFrame(vec3 up) {
  const vec3 u = glm::normalize(up);
  const vec3 notParallel = std::abs(u.z) < 0.9f ? vec3(0, 0, 1) : vec3(1, 0, 0);
  const vec3 right = glm::normalize(glm::cross(u, notParallel));
  return {right, u, glm::cross(right, u)};
}

Angles anglesOf(vec3 v, const Frame& f) {
  const float y = std::clamp(glm::dot(glm::normalize(v), f.up), -1.0f, 1.0f);
  return {std::atan2(glm::dot(v, f.right), glm::dot(v, f.back)), std::asin(y)};
}

vec3 direction(Angles a, const Frame& f) {
  return (f.right * std::sin(a.yaw) + f.back * std::cos(a.yaw)) * std::cos(a.pitch) + f.up * std::sin(a.pitch);
}

vec3 turned(vec3 v, vec3 up, float yaw, float pitch) {
  const Frame f = worldFrame(up);
  Angles a = anglesOf(v, f);
  a.yaw += yaw;
  a.pitch = std::clamp(a.pitch + pitch, -kSteepest, kSteepest);
  return direction(a, f) * glm::length(v);
}

}  // namespace

void CameraController::setSceneSize(float diagonal) {
  if (diagonal > 0) size_ = diagonal;
}

void CameraController::orbit(float yaw, float pitch) {
  camera_.position = camera_.target + turned(camera_.position - camera_.target, camera_.up, yaw, pitch);
}

void CameraController::look(float yaw, float pitch) {
  camera_.target = camera_.position + turned(camera_.target - camera_.position, camera_.up, yaw, pitch);
}

void CameraController::pan(float right, float up) {
  const vec3 forward = camera_.target - camera_.position;
  const float height = 2 * glm::length(forward) * std::tan(camera_.verticalFov / 2);
  const vec3 f = glm::normalize(forward);
  const vec3 r = glm::normalize(glm::cross(f, camera_.up));
  const vec3 move = (r * right + glm::cross(r, f) * up) * height;
  camera_.position += move, camera_.target += move;
}

void CameraController::dolly(float notches) {
  const vec3 back = camera_.position - camera_.target;
  const float distance = std::max(glm::length(back) * std::pow(kDollyNotch, notches), kNearest * size_);
  camera_.position = camera_.target + glm::normalize(back) * distance;
}

void CameraController::fly(vec3 d, float seconds) {
  const vec3 f = glm::normalize(camera_.target - camera_.position);
  const vec3 r = glm::normalize(glm::cross(f, camera_.up));
  const vec3 move = (r * d.x + glm::normalize(camera_.up) * d.y + f * d.z) * (flySpeed() * seconds);
  camera_.position += move, camera_.target += move;
}

void CameraController::focus(vec3 point) {
  if (glm::length(point - camera_.position) > kNearest * size_) camera_.target = point;
}

void CameraController::changeSpeed(float factor) { speed_ = std::clamp(speed_ * factor, 0.002f, 10.0f); }

}  // namespace hl::ui
