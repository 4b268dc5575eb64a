#pragma once
// The folder of a sweep as others read it: results.json, results.csv, convergence.csv, report.md.
#include <filesystem>
#include <string>

#include "engine/sweep/summary.h"
#include "engine/sweep/sweep.h"

namespace hl {

/// All of them, each atomically. @throws Error(Run) where one cannot be written.
void writeResultsFolder(const SweepResults&);

std::string sweepJson(const SweepResults&, const Summary&);
/// One line for each run, metric and reference, and the path tracer's points likewise (column `kind`). README.md says what the columns are.
std::string sweepCsv(const SweepResults&);
std::string convergenceCsv(const SweepResults&);
/// For people: configurations, fronts, speed against error, bias and variance. Markdown.
std::string sweepReport(const SweepResults&, const Summary&);

/// EXR with preset and provenance; PFM where the import module is not there.
std::filesystem::path pictureOf(const std::filesystem::path& folder, size_t configuration);

}  // namespace hl
