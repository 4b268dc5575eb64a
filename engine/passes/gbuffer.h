#pragma once
// The G-buffer: what the camera sees first, at pixel centres (no pixel filter).
#include "engine/core/image.h"
#include "engine/gpu/frame_graph.h"
#include "engine/scene/gpu_scene.h"

namespace hl {

/// All of frame size, zero where there is no surface. Normals are unit and turned towards the camera.
struct GBuffer {
  GpuImage position;         ///< RGBA32F: world position; w: 1 front face, -1 back face, 0 no surface
  GpuImage normal;           ///< RGBA32F: mapped normal (equal to the smooth normal without a normal map); w: lightmap u
  GpuImage geometricNormal;  ///< RGBA32F: triangle's normal; w: lightmap v
  GpuImage albedo;           ///< RGBA16F: 0 on the back of a one-sided material
  GpuImage emission;         ///< RGBA16F: radiance towards the camera
  GpuImage ids;              ///< RG32U: triangle + 1, material
  int width = 0, height = 0;
};

/// Pass "gbuffer". `cornerUvs`: lightmap UVs, vec2 a triangle's corner, or empty where there is no lightmap.
GBuffer recordGBuffer(FrameGraph&, const GpuScene&, const Buffer& cornerUvs, const Camera&, int width, int height);

/// World to clip, reversed z with infinite far plane, y down as in Vulkan.
mat4 cameraMatrix(const Camera&, float aspect);

}  // namespace hl
