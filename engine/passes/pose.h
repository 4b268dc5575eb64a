#pragma once
// Geometry of a moment, on the device.
#include "engine/gpu/frame_graph.h"
#include "engine/scene/gpu_scene.h"

namespace hl {

/// Pass "scene: pose vertices": positions and normals of the vertices that move, from their rest pose through their objects' transforms (updateTransforms
/// first). What does not move is not touched.
void recordPose(FrameGraph&, const GpuScene&);

}  // namespace hl
