#include "engine/experiment/parameter_json.h"

#include <fmt/format.h>

#include "engine/core/error.h"
#include "engine/experiment/preset_names.h"

namespace hl {

std::string parameterText(const JsonReader& node, const ParamInfo& info) {
  std::string text;
  switch (info.type) {
    case ParamType::Bool:
      return node.boolean() ? "true" : "false";
    case ParamType::Float:
      text = shortestText(node.number());
      break;
    case ParamType::Enum:
      text = node.text();
      break;
    case ParamType::Int:
      if (!node.json().is_number_integer())
        throw node.refused(fmt::format("a whole number in {} is wanted, not {}", rangeText(info), node.found()));
      text = node.json().dump();
      break;
  }
  try {
    return formatParam(info, parseParam(info, text));
  } catch (const Error& e) {
    throw node.refused(e.what());
  }
}

nlohmann::ordered_json parameterJson(const ParamInfo& info, const std::string& text) {
  const ParamValue value = parseParam(info, text);
  switch (info.type) {
    case ParamType::Bool:
      return std::get<int32_t>(value) != 0;
    case ParamType::Int:
      return std::get<int32_t>(value);
    case ParamType::Float:
      // 0.1f as 0.1, not 0.10000000149011612: the same float is read back.
      return nlohmann::ordered_json::parse(shortestText(std::get<float>(value)));
    case ParamType::Enum:
      return formatParam(info, value);
  }
  return nullptr;
}

}  // namespace hl
