#pragma once
// `halflight report`: a folder of results as plots, for people and for a paper.
#include <QByteArray>
#include <QString>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/sweep/curves.h"

namespace hl::ui {

class Settings;

/// A plot in the report.
struct ReportPlot {
  std::string name;      ///< of its files, without an extension
  std::string title;
  size_t problem = 0;
  std::string nothing;   ///< why there is none, or ""
  std::string note;
  QByteArray png;
};

struct Report {
  std::vector<ReportPlot> plots;
  std::vector<std::string> files;  ///< in the order in which they were written
  size_t missing = 0, failed = 0;  ///< runs
};

/// What a folder that `halflight-cli bench` has written holds. @throws Error(BadInput) for one that holds no results, no run, or a damaged table.
std::shared_ptr<const SweepView> openResults(const std::filesystem::path& folder);

/// PNG, PDF and CSV of every plot, the tables, report.md and report.ipynb. `settings`: colours as the window has them; may be null.
/// Needs a QApplication, no display. @throws Error(BadInput) where `out` cannot be made or is a results folder itself (its report.md would go);
/// Error(Run) where a file cannot be written.
Report writeReport(const SweepView&, const std::filesystem::path& out, Settings* settings);

/// The index of the plots, and what the sweep says for people after it.
std::string reportMarkdown(const SweepView&, const Report&);

}  // namespace hl::ui
