#pragma once
// Procedural surfaces of scene files: quads, boxes and spheres, with a lightmap UV set where asked for.
#include <functional>
#include <vector>

#include "engine/scene/scene_description.h"

namespace hl {

/// Share of a chart's cell, on each side, that stays free in the lightmap UV set: one texel at 32 texels a cell.
inline constexpr float kShapeChartMargin = 1.0f / 32;

/// Adds the shapes to the scene. `material` gives the index of a material by name. With `lightmapUvs` each face (of a
/// quad or box: the face; of a uv_sphere, lathe or cloth: the whole; of an icosphere: a base triangle; of an arch: each of its eight sides) fills the square of one cell of
/// an n x n grid, less the margin; cells run along u first, in the order of shapes and of their faces, and n is the
/// least that holds them all.
void appendShapes(Scene&, const std::vector<Shape>&, bool lightmapUvs,
                  const std::function<uint32_t(const std::string&)>& material);

}  // namespace hl
