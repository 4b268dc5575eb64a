#pragma once
// Acceleration structures over triangles, for devices with ray tracing pipelines.
#include <cstdint>
#include <memory>
#include <string>

#include "engine/gpu/resources.h"

namespace hl {

struct AccelerationState;

/// One top-level structure over one bottom-level structure, and over a second one where there is geometry that moves; copies of the handle share it.
class AccelerationStructure {
 public:
  AccelerationStructure() = default;
  explicit operator bool() const { return state_ != nullptr; }
  uint64_t bytes() const;
  AccelerationState* state() const { return state_.get(); }
  explicit AccelerationStructure(std::shared_ptr<AccelerationState> s) : state_(std::move(s)) {}

 private:
  std::shared_ptr<AccelerationState> state_;
};

/// Triangles [firstTriangle, firstTriangle + triangleCount) of an index buffer (uvec3 each) over vec3 vertices, tightly packed. Shaders see
/// its number in the list as gl_GeometryIndexEXT, and count triangles from firstTriangle on.
struct TriangleGeometry {
  Buffer vertices, indices;
  uint32_t vertexCount = 0, firstTriangle = 0, triangleCount = 0;
  bool opaque = true;  ///< no any-hit shader is asked
};

/// Updates of a structure between two full builds of what moves: an update only fits the boxes, which overlap more and more as things turn.
inline constexpr uint32_t kUpdatesABuild = 32;

}  // namespace hl
