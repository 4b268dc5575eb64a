#pragma once
// Line by line through OBJ and MTL text, and word by word through a line.
#include <charconv>
#include <cstdint>
#include <string_view>

namespace hl {

/// Logical lines: a backslash at the end of a line joins it with the next. Line numbers are those of the first physical
/// line.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : text_(text) {}

  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    number_ = nextNumber_;
    size_t end = at_;
    for (;;) {
      end = text_.find('\n', end);
      ++nextNumber_;
      if (end == std::string_view::npos) {
        end = text_.size();
        break;
      }
      size_t last = end;
      if (last > at_ && text_[last - 1] == '\r') --last;
      if (last == at_ || text_[last - 1] != '\\') break;
      ++end;
      if (end >= text_.size()) break;
    }
    line = text_.substr(at_, end - at_);
    at_ = end + 1;
    return true;
  }
  uint64_t number() const { return number_; }

 private:
  std::string_view text_;
  size_t at_ = 0;
  uint64_t number_ = 0, nextNumber_ = 1;
};

inline bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

/// Takes the next word off the line; empty at its end. A backslash alone is a joined line's, and counts as blank.
inline std::string_view takeWord(std::string_view& line) {
  size_t begin = 0;
  while (begin < line.size() &&
         (isBlank(line[begin]) || (line[begin] == '\\' && begin + 1 < line.size() && isBlank(line[begin + 1]))))
    ++begin;
  size_t end = begin;
  while (end < line.size() && !isBlank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// The rest of the line without blanks at its ends: a file or material name, which may have blanks inside.
inline std::string_view restOf(std::string_view line) {
  while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
  while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
  return line;
}

/// The whole word as a number of type T.
template <class T>
bool parseNumber(std::string_view word, T& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace hl
