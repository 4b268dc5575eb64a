#include "engine/core/error.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <string_view>

namespace hl {

namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// Insertions, deletions, changes and swaps of neighbours that lead from a to b, letter case aside.
size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> beforeLast, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t change = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + change});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], beforeLast[j - 2] + 1);
    }
    beforeLast = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

int Error::exitCode() const {
  switch (kind_) {
    case ErrorKind::Run:
    case ErrorKind::TooLarge:
      return 1;
    case ErrorKind::BadInput:
      return 2;
    case ErrorKind::Device:
      return 3;
    case ErrorKind::Cancelled:
      return 130;
  }
  return 1;
}

std::string nearest(const std::string& word, const std::vector<std::string>& candidates) {
  const size_t near = std::max<size_t>(2, word.size() / 3);
  size_t best = near + 1;
  std::string found;
  for (const std::string& candidate : candidates) {
    size_t distance = editDistance(word, candidate);
    // A dotted key is often typed without its group.
    const size_t dot = candidate.rfind('.');
    if (dot != std::string::npos && word.find('.') == std::string::npos)
      distance = std::min(distance, editDistance(word, std::string_view(candidate).substr(dot + 1)));
    // As many edits as letters is no likeness.
    if (distance < best && distance < std::max<size_t>(1, word.size())) best = distance, found = candidate;
  }
  return found;
}

}  // namespace hl
