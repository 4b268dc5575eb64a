#pragma once
// Strict reading of JSON: every refusal names the file, the path in it, what was found and what would be right. For
// .cpp files only: it brings nlohmann's header along.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace hl {

/// A value with where it stands: `camera.position[1]` of `preset.json`. Refers to the parsed document, which must
/// outlive it.
class JsonReader {
 public:
  JsonReader(const nlohmann::json& value, std::string file, std::string path = {})
      : value_(value), file_(std::move(file)), path_(std::move(path)) {}

  const nlohmann::json& json() const { return value_; }
  bool isObject() const { return value_.is_object(); }
  bool isText() const { return value_.is_string(); }

  /// All @throw Error(BadInput).
  const JsonReader& wantObject() const;
  bool has(const char* key) const { return value_.contains(key); }
  JsonReader at(const std::string& key) const;               ///< a missing key is an error
  std::vector<JsonReader> elements(const char* what) const;  ///< of an array
  std::string text() const;
  bool boolean() const;
  int64_t whole(int64_t low, int64_t high) const;
  float number(float low, float high) const;
  float number() const;    ///< finite
  vec3 vector() const;     ///< three finite numbers
  vec3 direction() const;  ///< of a length other than zero, as it stands
  std::vector<std::string> unknownKeys(const std::vector<std::string>& known) const;

  /// "file: path: message", to be thrown.
  class Error refused(const std::string& message) const;
  /// What the value is, for messages: `the text "abc"`, `the number 3`.
  std::string found() const;

 private:
  const nlohmann::json& value_;
  std::string file_, path_;
};

/// @throws Error(BadInput) with line and column, also for a key that stands twice in one object and for numbers beyond
/// double's range.
nlohmann::json parseStrictJson(const std::string& text, const std::string& file);

}  // namespace hl
