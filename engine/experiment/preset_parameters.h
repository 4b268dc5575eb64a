#pragma once
// The parameters that a preset may set: its technique's and the shared ones, with their declarations.
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/params/param.h"

namespace hl {

/// Tables of the technique's group, then the shared ones. @throws Error(BadInput) for an unknown technique.
std::vector<std::span<const ParamInfo>> parameterGroups(const std::string& technique);

/// The declaration of `key` among the groups; null where there is none.
const ParamInfo* findParameter(std::span<const std::span<const ParamInfo>> groups, std::string_view key);
std::string nearestParameter(std::span<const std::span<const ParamInfo>> groups, const std::string& key);

/// The same values written one way ("on" becomes "true", "0.50" "0.5"), without those that are the default. Keys nobody
/// knows stay.
std::map<std::string, std::string> canonicalParameters(const std::string& technique,
                                                       const std::map<std::string, std::string>&);

}  // namespace hl
