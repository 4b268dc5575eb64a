#pragma once
// The G-buffer: what the camera sees first, at pixel centres (no pixel filter).
#include "engine/core/image.h"
#include "engine/gpu/frame_graph.h"
#include "engine/scene/gpu_scene.h"

namespace hl {

/// All of frame size, zero where there is no surface. Normals are unit and turned towards the camera.
struct GBuffer {
  GpuImage position;  ///< RGBA32F: world position; w: 1 front face, -1 back face, 0 no surface
  GpuImage normal;    ///< RGBA32F: mapped normal (equal to the smooth normal without a normal map); w: lightmap u
  GpuImage geometricNormal;  ///< RGBA32F: triangle's normal; w: lightmap v
  GpuImage albedo;           ///< RGBA32F: 0 on the back of a one-sided material
  GpuImage emission;         ///< RGBA32F (16 bits would overflow at 65504): radiance towards the camera
  GpuImage specular;         ///< RGBA32F: reflectance at normal incidence, 0 on diffuse surfaces and on the back of a one-sided material; w: roughness (perceptual).
                             ///< Empty where the scene has no glossy surfaces
  GpuImage ids;              ///< RG32U: triangle + 1, material
  GpuImage motion;           ///< RG32F [pixels]: where this pixel's surface (or its direction, where there is none) was in the previous frame, minus where
                             ///< it is; y down. Far outside the image where it was behind the camera. Empty unless recordMotion() was called.
  int width = 0, height = 0;
};

/// Passes "gbuffer: visibility" (which triangle) and "gbuffer: surfaces" (what is there); "gbuffer: specular" (lobes), where the scene has glossy surfaces. `cornerUvs`: lightmap UVs,
/// vec2 a triangle's corner, or empty where there is no lightmap.
GBuffer recordGBuffer(FrameGraph&, const GpuScene&, const Buffer& cornerUvs, const Camera&, int width, int height);

/// Pass "gbuffer: motion". The surface is carried back through its object's transforms and seen with the previous camera; exactly 0 where neither moved.
void recordMotion(FrameGraph&, GBuffer&, const GpuScene&, const Camera& now, const Camera& previous);

/// A camera as rays: those through the image reach from the origin along forward + x right + y down, with x and y in
/// [-1, 1].
struct CameraBasis {
  vec3 origin{0.0f}, forward{0, 0, -1};  ///< forward: unit
  vec3 right{1, 0, 0}, down{0, -1, 0};   ///< half of the image plane's sides at distance 1
  float nearPlane = 0;                   ///< [m]
};
CameraBasis cameraBasis(const Camera&, float aspect);
/// Not unit. `x`, `y` in pixels: a pixel's centre lies at its index plus a half.
vec3 pixelDirection(const CameraBasis&, float x, float y, int width, int height);

/// World to clip, reversed z with infinite far plane, y down as in Vulkan.
mat4 cameraMatrix(const Camera&, float aspect);

}  // namespace hl
