#include "ui/catalog.h"

#include <cctype>

#include "engine/params/groups.h"
#include "engine/session/probe_views.h"

namespace hl::ui {

std::string defaultText(const ParamInfo& p) {
  return formatParam(p, p.type == ParamType::Float ? ParamValue(static_cast<float>(p.def))
                                                   : ParamValue(static_cast<int32_t>(p.def)));
}

std::string readableName(std::string_view identifier) {
  std::string text(identifier);
  for (char& c : text)
    if (c == '_') c = ' ';
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

Catalog::Catalog() {
  for (const std::span<const ParamInfo> infos : sharedParamGroups()) {
    if (infos.empty()) continue;
    const std::string id(infos.front().group);
    shared_.push_back({id, readableName(id), infos});
  }
  for (const TechniqueInfo& info : techniqueInfos()) {
    TechniqueEntry entry{std::string(info.id), std::string(info.label), std::string(info.summary), {}, {}};
    auto instance = info.create();
    if (!instance->params().infos().empty()) entry.groups.push_back({entry.id, entry.label, instance->params().infos()});
    for (const ParameterGroup& group : shared_)
      if ((group.id != "lightmap" || instance->needs().lightmap) && (group.id != "probes" || instance->needs().probes)) entry.groups.push_back(group);
    for (const DebugView& view : instance->debugViews()) entry.views.push_back({view.id, view.label});
    if (instance->needs().probes)
      for (const ViewInfo& view : probeViews()) entry.views.push_back(view);
    techniques_.push_back(std::move(entry));
    instances_.push_back(std::move(instance));
  }
}

const TechniqueEntry* Catalog::technique(const std::string& id) const {
  for (const TechniqueEntry& t : techniques_)
    if (t.id == id) return &t;
  return nullptr;
}

const ParamInfo* Catalog::parameter(const std::string& id, const std::string& key) const {
  const auto search = [&](const std::vector<ParameterGroup>& groups) -> const ParamInfo* {
    for (const ParameterGroup& group : groups)
      for (const ParamInfo& p : group.infos)
        if (p.key() == key) return &p;
    return nullptr;
  };
  const TechniqueEntry* entry = technique(id);
  const ParamInfo* found = entry ? search(entry->groups) : nullptr;
  return found ? found : search(shared_);
}

std::vector<ViewInfo> Catalog::views(const std::string& id) const {
  std::vector<ViewInfo> out = displayViews();
  if (const TechniqueEntry* entry = technique(id)) out.insert(out.end(), entry->views.begin(), entry->views.end());
  return out;
}

}  // namespace hl::ui
