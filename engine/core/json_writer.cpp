#include "engine/core/json_writer.h"

#include <fmt/format.h>

#include <cmath>

namespace hl {

void JsonWriter::line() {
  out_ += '\n';
  out_.append(2 * filled_.size(), ' ');
}

void JsonWriter::before() {
  if (afterKey_) {
    afterKey_ = false;
    return;
  }
  if (filled_.empty()) return;
  if (filled_.back()) out_ += ',';
  filled_.back() = true;
  line();
}

JsonWriter& JsonWriter::open(char c) {
  before();
  out_ += c;
  filled_.push_back(false);
  return *this;
}

JsonWriter& JsonWriter::close(char c) {
  const bool any = filled_.back();
  filled_.pop_back();
  if (any) line();
  out_ += c;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  text(name);
  out_ += ": ";
  afterKey_ = true;
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view value) {
  before();
  out_ += '"';
  for (const char c : value) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out_ += '\\', out_ += c;
    else if (c == '\n')
      out_ += "\\n";
    else if (code < 32)
      out_ += fmt::format("\\u{:04x}", code);
    else
      out_ += c;
  }
  out_ += '"';
  return *this;
}

JsonWriter& JsonWriter::number(double value) {
  if (!std::isfinite(value)) return null();
  return raw(fmt::format("{}", value));
}

JsonWriter& JsonWriter::whole(int64_t value) { return raw(fmt::format("{}", value)); }
JsonWriter& JsonWriter::boolean(bool value) { return raw(value ? "true" : "false"); }
JsonWriter& JsonWriter::null() { return raw("null"); }

JsonWriter& JsonWriter::raw(std::string_view json) {
  before();
  while (!json.empty() && json.back() == '\n') json.remove_suffix(1);
  for (const char c : json) {
    if (c == '\n')
      line();
    else
      out_ += c;
  }
  return *this;
}

}  // namespace hl
