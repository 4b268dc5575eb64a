#pragma once
#include <string>

namespace hl {

/// JSON Schema (draft 2020-12) of presets, with the parameters of every technique: for editors that complete and check.
std::string presetSchema();
/// Of what a file may be: a preset, or (where it has a "base") an experiment.
std::string fileSchema();

}  // namespace hl
