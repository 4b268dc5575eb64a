#pragma once
// results.csv, as tests compare it.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/cli_process.h"

namespace hl::test {

/// The rows of the table that do not depend on how fast the machine was: runs, without the columns of times.
inline std::vector<std::vector<std::string>> tableOf(const std::filesystem::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::vector<bool> kept;
  std::istringstream text(contentOf(file));
  for (std::string line; std::getline(text, line);) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    }
    if (kept.empty())
      for (const std::string& name : cells) kept.push_back(!name.ends_with("_ms"));
    EXPECT_EQ(cells.size(), kept.size()) << line;
    if (cells.front() == "path_tracer") continue;
    std::vector<std::string> row;
    for (size_t i = 0; i < cells.size(); ++i)
      if (kept[i]) row.push_back(cells[i]);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace hl::test
