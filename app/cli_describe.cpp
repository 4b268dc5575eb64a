// `describe`: every parameter, as text, as Markdown, or as the JSON Schema of presets and experiments.
#include <fmt/format.h>

#include "app/cli_commands.h"
#include "engine/core/error.h"
#include "engine/experiment/preset_schema.h"
#include "engine/params/groups.h"
#include "engine/params/markdown.h"
#include "engine/techniques/technique.h"

namespace hl::cli {
namespace {

std::string markdown() {
  std::string out =
      "# Parameters\n\nWritten by `halflight-cli describe --markdown` from the declarations in the source; a test "
      "compares it with them.\n"
      "A change takes effect with the next frame (*live*), starts histories and long work again (*reset*), or "
      "allocation and\n"
      "precomputation too (*rebuild*). Keys are those of presets and of `--set`.\n\n";
  for (const TechniqueInfo& t : techniqueInfos())
    out += parametersMarkdown(fmt::format("`{}`: {}", t.id, t.label), t.summary, t.create()->params().infos()) + "\n";
  for (const auto& group : sharedParamGroups())
    out += parametersMarkdown(fmt::format("`{}`, shared", group.front().group), "For every technique that uses it.",
                              group) +
           "\n";
  out.pop_back();
  return out;
}

std::string plain() {
  std::string out;
  const auto add = [&](std::span<const ParamInfo> infos) {
    for (const ParamInfo& p : infos) {
      std::string range;
      if (p.type == ParamType::Enum)
        for (const EnumValue& v : p.values) range += fmt::format("{}{}", range.empty() ? "" : ", ", v.name);
      else
        range = p.type == ParamType::Bool ? "true, false" : rangeText(p);
      out += fmt::format("{} = {}  ({})\n    {}\n", p.key(), formatParam(p, defaultValue(p)), range, p.help);
      for (const EnumValue& v : p.values) out += fmt::format("    {}: {}\n", v.name, v.help);
    }
  };
  for (const TechniqueInfo& t : techniqueInfos()) add(t.create()->params().infos());
  for (const auto& group : sharedParamGroups()) add(group);
  return out;
}

}  // namespace

int describe(bool asMarkdown, bool asSchema) {
  if (asMarkdown && asSchema) throw badInput("describe: either --markdown or --schema");
  print(asSchema ? fileSchema() : asMarkdown ? markdown() : plain());
  return 0;
}

}  // namespace hl::cli
