#pragma once
// Where an alpha-tested surface has substance, on the host.
#include <vector>

#include "engine/scene/scene.h"

namespace hl {

/// Whether any texel of the material's texture falls below its cut-off, so that its triangles need testing.
bool alphaTested(const Scene&, const Material&);
/// One flag a triangle; empty where no triangle needs testing.
std::vector<bool> alphaTestedTriangles(const Scene&);
/// The texture's alpha at barycentrics (u, v) of the triangle, bilinear, is at least the material's cut-off. True for
/// untested materials.
bool opaqueAt(const Scene&, uint32_t triangle, float u, float v);

}  // namespace hl
