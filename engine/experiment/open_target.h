#pragma once
// What a person may name to open an experiment: a preset (name or file), a scene (name or file), a mesh, a bundle, or an
// image that carries its preset.
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image.h"
#include "engine/experiment/preset.h"

namespace hl {

/// The text attributes of images written by the programs: the preset as JSON, and where the numbers come from as JSON.
inline constexpr const char* kPresetAttribute = "halflight.preset";
inline constexpr const char* kProvenanceAttribute = "halflight.provenance";

/// A file, else a preset's name, else a scene's name (which the scene loader judges). A scene or mesh gets the default
/// preset with that scene.
/// @throws Error(BadInput) for a preset or image that cannot be read, or an image without a preset.
Preset openTarget(const std::string& nameOrPath);

/// @throws Error(BadInput) for parameters that the preset's technique does not have, or values out of range.
void checkParameters(const Preset&);

/// @throws Error(BadInput) naming the nearest known metric.
void checkMetrics(const std::vector<std::string>&);

}  // namespace hl
