#pragma once
#include <string>

namespace hl {

/// JSON Schema (draft 2020-12) of presets, with the parameters of every technique: for editors that complete and check.
std::string presetSchema();

}  // namespace hl
