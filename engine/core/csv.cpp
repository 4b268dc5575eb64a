#include "engine/core/csv.h"

#include <fmt/format.h>

#include <cmath>

namespace hl {

std::string csvCell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + '"';
}

std::string csvCell(double v) { return std::isfinite(v) ? fmt::format("{}", v) : ""; }

}  // namespace hl
