#include "engine/experiment/preset_migration.h"

#include <fmt/format.h>

#include "engine/core/error.h"

namespace hl {

std::span<const Migration> presetMigrations() { return {}; }

nlohmann::json migrated(nlohmann::json document, int from, int to, std::span<const Migration> steps,
                        std::vector<std::string>& notes) {
  for (int version = from; version < to; ++version) {
    bool found = false;
    for (const Migration& step : steps) {
      if (step.from != version) continue;
      step.apply(document);
      notes.push_back(fmt::format("version {}: {}", version, step.what));
      found = true;
    }
    if (!found) throw badInput(fmt::format("version {} of presets can no longer be read", version));
  }
  document["version"] = to;
  return document;
}

}  // namespace hl
