#pragma once
// What there is to choose from: techniques with their parameters and views, and the shared parameter groups. Fixed for a run of the program.
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/params/param.h"
#include "engine/passes/display.h"
#include "engine/techniques/technique.h"

namespace hl::ui {

struct ParameterGroup {
  std::string id, title;
  std::span<const ParamInfo> infos;
};

struct TechniqueEntry {
  std::string id, label, summary;
  std::vector<ParameterGroup> groups;  ///< its own first, then the shared ones that it uses
  std::vector<ViewInfo> views;         ///< its debug views
};

class Catalog {
 public:
  Catalog();
  const std::vector<TechniqueEntry>& techniques() const { return techniques_; }
  /// Null for an unknown id.
  const TechniqueEntry* technique(const std::string& id) const;
  /// Null where neither the technique nor a shared group declares the key.
  const ParamInfo* parameter(const std::string& technique, const std::string& key) const;
  /// The common views, then the technique's.
  std::vector<ViewInfo> views(const std::string& technique) const;

 private:
  std::vector<std::unique_ptr<Technique>> instances_;  // the tables belong to them
  std::vector<TechniqueEntry> techniques_;
  std::vector<ParameterGroup> shared_;
};

/// The default as text, as presets and `--set` write it.
std::string defaultText(const ParamInfo&);
/// "samples_per_frame" as a person reads it: "Samples per frame".
std::string readableName(std::string_view identifier);

}  // namespace hl::ui
