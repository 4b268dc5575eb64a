#include "engine/passes/pose.h"

namespace hl {

void recordPose(FrameGraph& graph, const GpuScene& scene) {
  if (scene.movingVertexCount == 0) return graph.skip("scene: pose vertices", "nothing moves");
  graph.compute("scene: pose vertices", "passes/pose_vertices.comp")
      .bind("movingVertices", scene.movingVertices, Access::Read)
      .bind("objectTransforms", scene.objectTransforms, Access::Read)
      .bind("positions", scene.positions, Access::ReadWrite)
      .bind("normals", scene.normals, Access::ReadWrite)
      .push(scene.movingVertexCount)
      .dispatchThreads(scene.movingVertexCount);
}

}  // namespace hl
