#pragma once
// A parameter's value between JSON and the text that presets keep. For .cpp files only: it brings nlohmann's header along.
#include <string>

#include "engine/experiment/json_reader.h"
#include "engine/params/param.h"

namespace hl {

/// The canonical text of a JSON value. @throws Error(BadInput) for a wrong type or a value out of range, with its place.
std::string parameterText(const JsonReader&, const ParamInfo&);
/// @throws Error(BadInput) for a text that is none of its values.
nlohmann::ordered_json parameterJson(const ParamInfo&, const std::string& text);

}  // namespace hl
