#include "engine/scene/animation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "engine/core/error.h"

namespace hl {
namespace {

constexpr int kBoundSamples = 64;

/// The two keys round a moment, and how far it lies between them; both the same at the ends.
struct Between {
  size_t before = 0, after = 0;
  double share = 0;
};

template <class Key>
Between between(const std::vector<Key>& keys, Repeat repeat, double time) {
  const double t = timeWithin(repeat, static_cast<double>(keys.back().time), time);
  const auto next = std::upper_bound(keys.begin(), keys.end(), t, [](double v, const Key& k) { return v < static_cast<double>(k.time); });
  Between b;
  b.after = static_cast<size_t>(next - keys.begin());
  b.before = b.after > 0 ? b.after - 1 : 0;
  if (b.after == keys.size()) b.after = b.before;
  const double from = static_cast<double>(keys[b.before].time), to = static_cast<double>(keys[b.after].time);
  b.share = to > from ? std::clamp((t - from) / (to - from), 0.0, 1.0) : 0.0;
  return b;
}

double eased(double x) { return x * x * (3 - 2 * x); }

template <class T>
T blend(const T& a, const T& b, double share) {
  // At a key it is that key, to the bit.
  if (share == 0 || a == b) return a;
  return a + (b - a) * static_cast<float>(share);
}

/// Along the great circle; opposite directions go through one that is across.
vec3 turned(vec3 a, vec3 b, double share) {
  if (share == 0 || a == b) return a;
  const double cosine = std::clamp(static_cast<double>(glm::dot(a, b)), -1.0, 1.0);
  const double angle = std::acos(cosine);
  if (angle < 1e-4) return glm::normalize(blend(a, b, share));
  vec3 across = b - static_cast<float>(cosine) * a;
  if (glm::length(across) < 1e-4f) across = glm::cross(a, std::abs(a.x) < 0.5f ? vec3(1, 0, 0) : vec3(0, 0, 1));
  across = glm::normalize(across);
  return glm::normalize(static_cast<float>(std::cos(angle * share)) * a + static_cast<float>(std::sin(angle * share)) * across);
}

/// Cubic Hermite through p1 and p2 with the tangents of Catmull and Rom for keys at unequal times.
template <class T, class Value>
T cubic(const std::vector<CameraKey>& keys, const Between& b, Value&& value) {
  const T p1 = value(keys[b.before].camera), p2 = value(keys[b.after].camera);
  if (b.share == 0 || b.before == b.after) return p1;
  const float h = keys[b.after].time - keys[b.before].time, s = static_cast<float>(b.share);
  const auto slope = [&](size_t from, size_t to) {
    return (value(keys[to].camera) - value(keys[from].camera)) * (1.0f / (keys[to].time - keys[from].time));
  };
  const T m1 = slope(b.before > 0 ? b.before - 1 : b.before, b.after);
  const T m2 = slope(b.before, b.after + 1 < keys.size() ? b.after + 1 : b.after);
  const float s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * p1 + (s3 - 2 * s2 + s) * h * m1 + (3 * s2 - 2 * s3) * p2 + (s3 - s2) * h * m2;
}

std::array<vec3, 8> corners(const Bounds& b) {
  std::array<vec3, 8> c;
  for (size_t i = 0; i < 8; ++i) c[i] = vec3(i & 1 ? b.max.x : b.min.x, i & 2 ? b.max.y : b.min.y, i & 4 ? b.max.z : b.min.z);
  return c;
}

}  // namespace

double timeWithin(Repeat repeat, double duration, double time) {
  if (!(duration > 0) || !(time > 0)) return 0;
  switch (repeat) {
    case Repeat::Once:
      return std::min(time, duration);
    case Repeat::Loop:
      return std::fmod(time, duration);
    case Repeat::PingPong: {
      const double t = std::fmod(time, 2 * duration);
      return t <= duration ? t : 2 * duration - t;
    }
  }
  return 0;
}

mat4 poseAt(const ObjectAnimation& a, double time) {
  const Between b = between(a.keys, a.repeat, time);
  const PoseKey &from = a.keys[b.before], &to = a.keys[b.after];
  const double share = a.eased ? eased(b.share) : b.share;
  const vec3 translation = blend(from.translation, to.translation, share), scale = blend(from.scale, to.scale, share);
  const float angle = blend(from.angle, to.angle, share);
  // What does nothing is left out: about a pivot it would round.
  mat4 m(1.0f);
  if (angle != 0 || scale != vec3(1.0f)) {
    m = glm::translate(mat4(1.0f), a.pivot + translation);
    if (angle != 0) m = glm::rotate(m, angle, a.axis);
    m = glm::translate(glm::scale(m, scale), -a.pivot);
  } else if (translation != vec3(0.0f)) {
    m = glm::translate(m, translation);
  }
  return m;
}

std::vector<mat4> posesAt(const Scene& scene, double time) {
  std::vector<mat4> out(scene.objects.size(), mat4(1.0f));
  for (const ObjectAnimation& a : scene.animations) {
    const mat4 pose = poseAt(a, time);
    for (const uint32_t object : a.objects) out[object] = pose * out[object];
  }
  return out;
}

LightKey lightAt(const LightAnimation& a, double time) {
  const Between b = between(a.keys, a.repeat, time);
  const LightKey &from = a.keys[b.before], &to = a.keys[b.after];
  const double share = a.eased ? eased(b.share) : b.share;
  LightKey out;
  out.time = static_cast<float>(time);
  out.position = blend(from.position, to.position, share);
  out.direction = turned(from.direction, to.direction, share);
  out.factor = blend(from.factor, to.factor, share);
  return out;
}

Camera cameraAt(const CameraPath& path, double time) {
  const Between b = between(path.keys, path.repeat, time);
  Camera c = path.keys[b.before].camera;
  c.name = path.name;
  c.position = cubic<vec3>(path.keys, b, [](const Camera& k) { return k.position; });
  c.target = cubic<vec3>(path.keys, b, [](const Camera& k) { return k.target; });
  c.up = turned(path.keys[b.before].camera.up, path.keys[b.after].camera.up, b.share);
  c.verticalFov = blend(path.keys[b.before].camera.verticalFov, path.keys[b.after].camera.verticalFov, b.share);
  return c;
}

bool animated(const Scene& scene) { return !scene.animations.empty() || !scene.lightAnimations.empty(); }

Bounds boundsOfPoses(const Scene& scene) {
  std::vector<Bounds> boxes(scene.objects.size());
  for (size_t t = 0; t < scene.indices.size(); ++t)
    for (const uint32_t v : {scene.indices[t].x, scene.indices[t].y, scene.indices[t].z}) boxes[scene.objectIds[t]].extend(scene.positions[v]);
  Bounds all;
  for (const Bounds& b : boxes)
    if (!b.empty()) all.extend(b.min), all.extend(b.max);
  std::set<double> times;
  for (const ObjectAnimation& a : scene.animations) {
    for (const PoseKey& k : a.keys) times.insert(static_cast<double>(k.time));
    for (int i = 0; i <= kBoundSamples; ++i) times.insert(static_cast<double>(a.keys.back().time) * i / kBoundSamples);
  }
  for (const double time : times) {
    const std::vector<mat4> poses = posesAt(scene, time);
    for (size_t o = 0; o < boxes.size(); ++o) {
      if (boxes[o].empty() || poses[o] == mat4(1.0f)) continue;
      for (const vec3 corner : corners(boxes[o])) all.extend(vec3(poses[o] * glm::vec4(corner, 1.0f)));
    }
  }
  return all;
}

void checkCameraPaths(const std::vector<CameraPath>& paths) {
  std::set<std::string> names;
  for (const CameraPath& p : paths) {
    if (p.name.empty() || !names.insert(p.name).second) throw badInput(fmt::format("camera path '{}': a name of its own is wanted", p.name));
    float last = -1;
    for (const CameraKey& k : p.keys) {
      if (!(k.time > last) || (last < 0 && k.time != 0))
        throw badInput(fmt::format("camera path '{}': its keys' times must ascend from 0, and {} s comes after {} s", p.name, k.time, std::max(last, 0.0f)));
      last = k.time;
    }
    if (p.keys.empty()) throw badInput(fmt::format("camera path '{}': it has no keys", p.name));
  }
}

const CameraPath& cameraPath(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (const CameraPath& p : scene.cameraPaths) {
    if (p.name == name) return p;
    names.push_back(p.name);
  }
  if (names.empty()) throw badInput(fmt::format("camera path '{}': the scene '{}' has none", name, scene.name));
  const std::string guess = nearest(name, names);
  throw badInput(fmt::format("camera path '{}': the scene '{}' has no such path{}", name, scene.name,
                             guess.empty() ? fmt::format("; it has {}", fmt::join(names, ", ")) : fmt::format(", did you mean '{}'?", guess)));
}

}  // namespace hl
