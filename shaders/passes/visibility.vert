#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of the scene's triangles, pulled from its buffers.
#define HL_SCENE_POSITIONS
#define HL_SCENE_MATERIALS
#include "shaders/passes/gbuffer.glsl"

layout(constant_id = 0) const bool kAlphaTested = false;

layout(location = 0) flat out uint triangle;
layout(location = 1) flat out uint alphaTested;  ///< whether this triangle can have holes

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  alphaTested = 0u;
  if (kAlphaTested) alphaTested = fetchMaterial(triangle).alphaCutoff > 0.0 ? 1u : 0u;
  const uint vertex = indices[triangle][uint(gl_VertexIndex) % 3u];
  gl_Position = camera.worldToClip * vec4(positions[vertex], 1.0);
}
