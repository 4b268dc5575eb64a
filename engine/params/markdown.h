#pragma once
// The parameters as Markdown, for docs/PARAMETERS.md.
#include <span>
#include <string>
#include <string_view>

#include "engine/params/param.h"

namespace hl {

/// A heading, a sentence, and a table with one row a parameter.
std::string parametersMarkdown(std::string_view heading, std::string_view summary, std::span<const ParamInfo>);

}  // namespace hl
