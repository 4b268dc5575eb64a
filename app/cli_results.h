#pragma once
// The results of a run as a summary for people.
#include "engine/session/results_json.h"

namespace hl::cli {

std::string resultsText(const RunResults&);

}  // namespace hl::cli
