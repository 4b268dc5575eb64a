#pragma once
// A scene's rest pose, kept apart while the scene itself is brought from moment to moment.
#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "shaders/shared/scene_types.h"

namespace hl {

class ScenePose {
 public:
  ScenePose() = default;
  /// `scene` at rest, as it was loaded. A vertex that objects share which do not move together must have been taken apart (separateMovingVertices).
  explicit ScenePose(const Scene& scene);

  bool movesGeometry() const { return !vertices_.empty(); }
  bool movesLights() const { return movesLights_; }

  struct Changed {
    bool geometry = false;    ///< vertices, normals (and with them emitters) are elsewhere
    bool lights = false;
    bool transforms = false;  ///< transforms() differ from the last call's, if only because what moved has come to rest
  };
  /// Brings `scene`, the one this was made of, to the moment: positions and normals of moving vertices, punctual lights. What does not move is not touched.
  Changed apply(Scene& scene, double time);
  /// Lights were edited: these are now what animations move.
  void setLights(const Scene& scene);
  /// Puts the lights at rest into `scene`: those that a person edits.
  void restLights(Scene& scene) const;

  const std::vector<shared::MovingVertex>& vertices() const { return vertices_; }
  /// One an object, as of the last apply() and the one before it.
  std::span<const shared::ObjectTransform> transforms() const { return transforms_; }

 private:
  struct Lights {
    std::vector<PointLight> points;
    std::vector<SpotLight> spots;
    std::vector<DirectionalLight> directionals;
  };
  void poseVertices(Scene&) const;
  Changed poseLights(Scene&, double time);

  std::vector<shared::MovingVertex> vertices_;
  std::vector<shared::ObjectTransform> transforms_;
  std::vector<mat4> poses_;
  Lights rest_;
  std::vector<LightKey> lightKeys_;  ///< as last applied
  bool movesLights_ = false, lightsStale_ = true;
};

/// One flag a triangle: whether its object moves at some time. Empty where none does.
std::vector<bool> movingTriangles(const Scene&);
/// Gives moving objects vertices of their own. Part of finishing a scene, before its hash.
void separateMovingVertices(Scene&);

}  // namespace hl
