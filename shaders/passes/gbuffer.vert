#version 460
#extension GL_GOOGLE_include_directive : require
// Corners of the scene's triangles, pulled from its buffers.
#define HL_SCENE_POSITIONS
#include "shaders/passes/gbuffer.glsl"
#include "shaders/scene.glsl"

layout(location = 0) flat out uint triangle;

void main() {
  triangle = uint(gl_VertexIndex) / 3u;
  const uint vertex = indices[triangle][uint(gl_VertexIndex) % 3u];
  gl_Position = camera.worldToClip * vec4(positions[vertex], 1.0);
}
