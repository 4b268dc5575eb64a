#pragma once
// How presets of older versions become presets of this one. For .cpp files only: it brings nlohmann's header along.
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace hl {

/// Turns a document of version `from` into one of version `from` + 1.
struct Migration {
  int from = 0;
  std::string what;  ///< for the person: "radiosity.rays is now radiosity.samples"
  std::function<void(nlohmann::json&)> apply;
};

/// Empty while kPresetVersion is 1: there is no older version. A change of format adds its step here and counts
/// kPresetVersion up.
std::span<const Migration> presetMigrations();

/// Applies the steps from version `from` to `to` in order, noting each. @throws Error(BadInput) where a step is
/// missing.
nlohmann::json migrated(nlohmann::json document, int from, int to, std::span<const Migration>,
                        std::vector<std::string>& notes);

}  // namespace hl
