#pragma once
// Cells of comma-separated tables.
#include <string>

namespace hl {

/// What a spreadsheet would take for two cells stands in quotes; line ends become spaces.
std::string csvCell(const std::string& text);
/// The shortest text that reads back as the same number; empty where it is not finite.
std::string csvCell(double);

}  // namespace hl
