#version 460
#extension GL_GOOGLE_include_directive : require
// Which triangle a pixel sees.
#define HL_SCENE_POSITIONS
#define HL_SCENE_UVS
#define HL_SCENE_MATERIALS
#define HL_SCENE_TEXTURES
#include "shaders/passes/gbuffer.glsl"

layout(constant_id = 0) const bool kAlphaTested = false;

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint alphaTested;
layout(location = 0) out uvec2 ids;

void main() {
  if (kAlphaTested && alphaTested != 0u) {
    const vec2 uv = fetchUv(triangle, meet(fetchTriangle(triangle), pixelDirection(gl_FragCoord.xy)));
    if (!materialOpaque(fetchMaterial(triangle), uv)) discard;
  }
  ids = uvec2(triangle + 1u, materialIds[triangle]);
}
