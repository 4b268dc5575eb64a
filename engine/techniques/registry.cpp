#include "engine/core/error.h"
#include "engine/techniques/technique.h"

namespace hl {

const TechniqueInfo& techniqueInfo(std::string_view id) {
  std::vector<std::string> known;
  for (const TechniqueInfo& info : techniqueInfos()) {
    if (info.id == id) return info;
    known.emplace_back(info.id);
  }
  const std::string near = nearest(std::string(id), known);
  std::string list;
  for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
  throw badInput("unknown technique \"" + std::string(id) + "\"" +
                 (near.empty() ? "" : "; did you mean \"" + near + "\"?") + " Known: " + list);
}

}  // namespace hl
