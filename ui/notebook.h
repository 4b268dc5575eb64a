#pragma once
// A Jupyter notebook (nbformat 4) that draws a report's plots again from its tables, with pandas and matplotlib.
#include <string>

#include "engine/sweep/curves.h"
#include "ui/report.h"

namespace hl::ui {

/// For the report's folder: reads results.csv, convergence.csv and the passes' tables there. The plots' pictures are its outputs.
std::string notebookJson(const SweepView&, const Report&);

}  // namespace hl::ui
