#include "engine/params/markdown.h"

#include <fmt/format.h>

namespace hl {
namespace {

/// A pipe would end the cell.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string rangeCell(const ParamInfo& p) {
  if (p.type == ParamType::Bool) return "`true`, `false`";
  if (p.type == ParamType::Enum) {
    std::string names;
    for (const EnumValue& v : p.values) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", v.name);
    return names;
  }
  return fmt::format("{}{}", rangeText(p), p.scale == ParamScale::Log ? ", log" : "");
}

std::string helpCell(const ParamInfo& p) {
  std::string text(p.help);
  for (const EnumValue& v : p.values)
    if (!v.help.empty()) text += fmt::format("<br>`{}`: {}", v.name, v.help);
  return cell(text);
}

const char* effectName(Effect effect) {
  switch (effect) {
    case Effect::Live:
      return "live";
    case Effect::Reset:
      return "reset";
    case Effect::Rebuild:
      return "rebuild";
  }
  return "";
}

}  // namespace

std::string parametersMarkdown(std::string_view heading, std::string_view summary, std::span<const ParamInfo> infos) {
  std::string out = fmt::format("## {}\n\n{}\n\n", heading, summary);
  if (infos.empty()) return out + "No parameters.\n";
  out += "| key | default | range | a change | what it does |\n| --- | --- | --- | --- | --- |\n";
  for (const ParamInfo& p : infos)
    out += fmt::format("| `{}` | `{}` | {} | {} | {} |\n", p.key(), formatParam(p, defaultValue(p)), rangeCell(p),
                       effectName(p.effect), helpCell(p));
  return out;
}

}  // namespace hl
