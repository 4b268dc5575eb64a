// Which of the scene's triangles was hit: the structure holds the opaque ones, then those that need an alpha test.
layout(constant_id = 0) const uint kFirstTested = 0;  // triangles of geometry 0

layout(scalar) readonly buffer scene_triangles_block { uint sceneTriangles[]; };

uint sceneTriangle() { return sceneTriangles[(gl_GeometryIndexEXT > 0 ? kFirstTested : 0u) + uint(gl_PrimitiveID)]; }
