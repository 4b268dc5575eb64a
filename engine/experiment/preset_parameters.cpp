#include "engine/experiment/preset_parameters.h"

#include "engine/core/error.h"
#include "engine/params/groups.h"
#include "engine/techniques/technique.h"

namespace hl {

std::vector<std::span<const ParamInfo>> parameterGroups(const std::string& technique) {
  std::vector<std::span<const ParamInfo>> groups;
  const auto made = techniqueInfo(technique).create();
  if (!made->params().infos().empty()) groups.push_back(made->params().infos());
  for (const auto& shared : sharedParamGroups()) groups.push_back(shared);
  return groups;
}

const ParamInfo* findParameter(std::span<const std::span<const ParamInfo>> groups, std::string_view key) {
  for (const auto& group : groups)
    for (const ParamInfo& p : group)
      if (p.key() == key) return &p;
  return nullptr;
}

std::string nearestParameter(std::span<const std::span<const ParamInfo>> groups, const std::string& key) {
  std::vector<std::string> known;
  for (const auto& group : groups)
    for (const ParamInfo& p : group) known.push_back(p.key());
  return nearest(key, known);
}

std::map<std::string, std::string> canonicalParameters(const std::string& technique,
                                                       const std::map<std::string, std::string>& parameters) {
  const auto groups = parameterGroups(technique);
  std::map<std::string, std::string> out;
  for (const auto& [key, text] : parameters) {
    const ParamInfo* p = findParameter(groups, key);
    if (!p) {
      out[key] = text;
      continue;
    }
    const ParamValue value = parseParam(*p, text);
    if (value != defaultValue(*p)) out[key] = formatParam(*p, value);
  }
  return out;
}

}  // namespace hl
