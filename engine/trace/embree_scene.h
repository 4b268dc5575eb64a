#pragma once
// Embree over the scene's triangles, on the host. Embree's headers are in embree_scene.cpp alone.
#include <memory>
#include <span>

#include "engine/core/progress.h"
#include "engine/core/task_pool.h"
#include "engine/scene/scene.h"
#include "engine/trace/ray_packet.h"
#include "shaders/shared/ray.h"

namespace hl {

/// The point of the scene's surfaces that is closest to another.
struct NearestPoint {
  uint32_t triangle = kNone;  ///< none within the distance asked for
  float distance = 0;         ///< [m]
  vec3 position{0.0f};
};

class EmbreeScene {
 public:
  /// Keeps a reference to `scene` (positions, UVs and textures for alpha tests): it must outlive this.
  explicit EmbreeScene(const Scene& scene, Progress* = nullptr);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Moving objects are elsewhere in the scene now: their geometry follows, the rest stays as it is. Not while rays are cast. No work where nothing can move.
  void update();

  shared::Hit closest(const shared::Ray&) const;  ///< one ray; thread-safe
  bool occluded(const shared::Ray&) const;
  /// Batches on this thread, coherent or not.
  void closest(std::span<const shared::Ray>, std::span<shared::Hit>) const;
  void occluded(std::span<const shared::Ray>, std::span<uint32_t>) const;
  /// The packet's first `count` rays, on this thread.
  void closest(RayPacket&, size_t count) const;
  /// Within `radius` [m]; of several at one distance that of the lowest triangle. Alpha tests are not asked. Thread-safe.
  NearestPoint nearest(vec3 point, float radius) const;
  const Scene& scene() const { return scene_; }
  uint64_t bytes() const;  ///< what Embree and this hold

 private:
  const Scene& scene_;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hl
