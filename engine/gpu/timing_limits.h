#pragma once
// When the times of passes tell the whole.

namespace hl {

/// Share of a frame's wall time that may be in no pass; above it whoever prints the passes' times says so (BatchTimings::unaccounted, engine/gpu/profiler.h).
inline constexpr double kUnaccountedLimit = 0.1;

}  // namespace hl
