#include "engine/experiment/json_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/core/error.h"

namespace hl {
namespace {

std::string shortened(const std::string& text) { return text.size() <= 60 ? text : text.substr(0, 57) + "..."; }

std::string lineAndColumn(const std::string& text, size_t byte) {
  const size_t end = std::min(byte > 0 ? byte - 1 : 0, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
  const size_t lineStart = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  const size_t column = lineStart == std::string::npos ? end + 1 : end - lineStart;
  return fmt::format("line {}, column {}", line, column);
}

/// The parser's own words without its error number and its idea of the place.
std::string reasonOf(const std::string& what) {
  std::string reason = what;
  const size_t place = reason.find(": ");
  if (reason.rfind("[json.exception", 0) == 0) reason = reason.substr(std::min(reason.find("] ") + 2, reason.size()));
  if (place != std::string::npos && reason.rfind("parse error", 0) == 0) reason = reason.substr(reason.find(": ") + 2);
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return shortened(reason).size() == reason.size() ? reason : reason.substr(0, 160);
}

}  // namespace

Error JsonReader::refused(const std::string& message) const {
  return badInput(path_.empty() ? fmt::format("{}: {}", file_, message)
                                : fmt::format("{}: {}: {}", file_, path_, message));
}

std::string JsonReader::found() const {
  using Type = nlohmann::json::value_t;
  switch (value_.type()) {
    case Type::null:
      return "null";
    case Type::object:
      return "an object";
    case Type::array:
      return fmt::format("an array of {}", value_.size());
    case Type::string:
      return fmt::format("the text {}",
                         shortened(value_.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace)));
    case Type::boolean:
      return value_.get<bool>() ? "true" : "false";
    default:
      return fmt::format("the number {}", value_.dump());
  }
}

const JsonReader& JsonReader::wantObject() const {
  if (!value_.is_object()) throw refused("an object is wanted, not " + found());
  return *this;
}

JsonReader JsonReader::at(const std::string& key) const {
  wantObject();
  const auto member = value_.find(key);
  if (member == value_.end()) throw refused(fmt::format("the key \"{}\" is missing", key));
  // A dotted key would read as a path.
  const std::string shown = key.find('.') == std::string::npos ? key : "\"" + key + "\"";
  return JsonReader(*member, file_, path_.empty() ? shown : path_ + "." + shown);
}

std::vector<JsonReader> JsonReader::elements(const char* what) const {
  if (!value_.is_array()) throw refused(fmt::format("{} is wanted, not {}", what, found()));
  std::vector<JsonReader> out;
  for (size_t i = 0; i < value_.size(); ++i) out.emplace_back(value_[i], file_, fmt::format("{}[{}]", path_, i));
  return out;
}

std::string JsonReader::text() const {
  if (!value_.is_string()) throw refused("a text is wanted, not " + found());
  return value_.get<std::string>();
}

bool JsonReader::boolean() const {
  if (!value_.is_boolean()) throw refused("true or false is wanted, not " + found());
  return value_.get<bool>();
}

int64_t JsonReader::whole(int64_t low, int64_t high) const {
  if (!value_.is_number_integer())
    throw refused(fmt::format("a whole number in [{}, {}] is wanted, not {}", low, high, found()));
  const bool beyond = value_.is_number_unsigned() &&
                      value_.get<uint64_t>() > static_cast<uint64_t>(std::numeric_limits<int64_t>::max());
  const int64_t v = beyond ? std::numeric_limits<int64_t>::max() : value_.get<int64_t>();
  if (v < low || v > high) throw refused(fmt::format("{} is out of range [{}, {}]", value_.dump(), low, high));
  return v;
}

float JsonReader::number() const {
  if (!value_.is_number()) throw refused("a number is wanted, not " + found());
  const double v = value_.get<double>();
  if (!(std::abs(v) <= static_cast<double>(std::numeric_limits<float>::max())))
    throw refused(fmt::format("{} is beyond what a 32-bit float holds", value_.dump()));
  return static_cast<float>(v);
}

float JsonReader::number(float low, float high) const {
  const float v = number();
  if (v < low || v > high) throw refused(fmt::format("{} is out of range [{}, {}]", value_.dump(), low, high));
  return v;
}

vec3 JsonReader::vector() const {
  const std::vector<JsonReader> parts = elements("an array of three numbers");
  if (parts.size() != 3) throw refused(fmt::format("an array of three numbers is wanted, not of {}", parts.size()));
  return vec3(parts[0].number(), parts[1].number(), parts[2].number());
}

vec3 JsonReader::direction() const {
  const vec3 v = vector();
  if (!(glm::length(v) > 0)) throw refused("a direction of a length other than zero is wanted");
  return v;
}

std::vector<std::string> JsonReader::unknownKeys(const std::vector<std::string>& known) const {
  std::vector<std::string> out;
  wantObject();
  for (const auto& member : value_.items())
    if (std::find(known.begin(), known.end(), member.key()) == known.end()) out.push_back(member.key());
  return out;
}

nlohmann::json parseStrictJson(const std::string& text, const std::string& file) {
  using Json = nlohmann::json;
  std::vector<std::set<std::string>> open;  // keys so far of the objects that are being read
  std::string twice;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second && twice.empty())
      twice = parsed.get<std::string>();
    return true;
  };
  Json document;
  try {
    document = Json::parse(text, watch);
  } catch (const Json::parse_error& e) {
    throw badInput(fmt::format("{}: {}: not valid JSON: {}", file, lineAndColumn(text, e.byte), reasonOf(e.what())));
  } catch (const Json::exception& e) {  // a number beyond double's range
    throw badInput(fmt::format("{}: not valid JSON: {}", file, reasonOf(e.what())));
  }
  if (!twice.empty()) throw badInput(fmt::format("{}: the key \"{}\" stands twice in one object", file, twice));
  return document;
}

}  // namespace hl
