// Which of the scene's triangles was hit: the structures hold what stays and what moves, each opaque triangles first, then those that need an alpha test.
layout(constant_id = 0) const uint kFirstTested = 0;
layout(constant_id = 1) const uint kFirstMoving = 0;
layout(constant_id = 2) const uint kFirstMovingTested = 0;

layout(scalar) readonly buffer scene_triangles_block { uint sceneTriangles[]; };

uint sceneTriangle() {
  const bool moves = gl_InstanceCustomIndexEXT > 0, tested = gl_GeometryIndexEXT > 0;
  const uint first = moves ? (tested ? kFirstMovingTested : kFirstMoving) : (tested ? kFirstTested : 0u);
  return sceneTriangles[first + uint(gl_PrimitiveID)];
}
