#pragma once
// Strict reading of a JSON object: every key is known, every value has its type and range, and a message says where it
// is.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/math.h"

namespace hl {

inline Error badInput(const std::string& place, const std::string& what) {
  return badInput(fmt::format("{}: {}", place, what));
}

/// Parses text. @throws Error(BadInput) with line and column.
nlohmann::json parseJson(std::string_view text, const std::string& file);

class JsonObject {
 public:
  /// `place` is how messages begin, e.g. "box.json: lights[0]".
  JsonObject(const nlohmann::json& value, std::string place) : value_(value), place_(std::move(place)) {
    if (!value.is_object()) throw badInput(place_, fmt::format("an object is wanted, not {}", typeName(value)));
  }
  const std::string& place() const { return place_; }

  /// The value under `key`, or nullptr; the key counts as known from here on.
  const nlohmann::json* find(const char* key) {
    known_.insert(key);
    const auto it = value_.find(key);
    return it == value_.end() ? nullptr : &*it;
  }
  const nlohmann::json& need(const char* key) {
    if (const nlohmann::json* v = find(key)) return *v;
    throw badInput(place_, fmt::format("'{}' is missing", key));
  }
  std::string at(std::string_view key) const { return fmt::format("{}.{}", place_, key); }

  bool boolean(const char* key, bool otherwise) {
    const nlohmann::json* v = find(key);
    if (!v) return otherwise;
    if (!v->is_boolean()) throw badInput(at(key), fmt::format("true or false is wanted, not {}", typeName(*v)));
    return v->get<bool>();
  }
  std::string text(const char* key, const std::string& otherwise) {
    const nlohmann::json* v = find(key);
    return v ? asText(*v, at(key)) : otherwise;
  }
  double number(const char* key, double otherwise, double min, double max) {
    const nlohmann::json* v = find(key);
    return v ? asNumber(*v, at(key), min, max) : otherwise;
  }
  int integer(const char* key, int otherwise, int min, int max) {
    const nlohmann::json* v = find(key);
    if (!v) return otherwise;
    if (!v->is_number_integer()) throw badInput(at(key), fmt::format("a whole number is wanted, not {}", typeName(*v)));
    return static_cast<int>(asNumber(*v, at(key), min, max));
  }

  /// @throws Error(BadInput) for a key that nobody asked for, with the nearest that exists.
  void refuseUnknown() const {
    for (const auto& [key, unused] : value_.items()) {
      if (known_.count(key)) continue;
      const std::string near = nearest(key, {known_.begin(), known_.end()});
      throw badInput(place_, near.empty() ? fmt::format("unknown key '{}'; known are {}", key, fmt::join(known_, ", "))
                                          : fmt::format("unknown key '{}'; did you mean '{}'?", key, near));
    }
  }

  static std::string typeName(const nlohmann::json& v) {
    return v.is_null() ? "null" : (v.is_array() || v.is_object() ? "an " : "a ") + std::string(v.type_name());
  }
  static std::string asText(const nlohmann::json& v, const std::string& place) {
    if (!v.is_string()) throw badInput(place, fmt::format("a string is wanted, not {}", typeName(v)));
    return v.get<std::string>();
  }
  static double asNumber(const nlohmann::json& v, const std::string& place, double min, double max) {
    if (!v.is_number()) throw badInput(place, fmt::format("a number is wanted, not {}", typeName(v)));
    const double x = v.get<double>();
    if (!(x >= min && x <= max)) throw badInput(place, fmt::format("{} is out of range [{}, {}]", x, min, max));
    return x;
  }
  /// Three numbers; `grey` also takes one for all three.
  static vec3 asVec3(const nlohmann::json& v, const std::string& place, double min, double max, bool grey = false) {
    if (grey && v.is_number()) return vec3(static_cast<float>(asNumber(v, place, min, max)));
    if (!v.is_array() || v.size() != 3)
      throw badInput(place, fmt::format("{}three numbers are wanted, not {}", grey ? "one or " : "",
                                        v.is_array() ? fmt::format("{} values", v.size()) : typeName(v)));
    vec3 out{};
    for (int i = 0; i < 3; ++i)
      out[i] = static_cast<float>(asNumber(v[static_cast<size_t>(i)], fmt::format("{}[{}]", place, i), min, max));
    return out;
  }
  static const nlohmann::json& asArray(const nlohmann::json& v, const std::string& place) {
    if (!v.is_array()) throw badInput(place, fmt::format("an array is wanted, not {}", typeName(v)));
    return v;
  }

 private:
  const nlohmann::json& value_;
  std::string place_;
  std::set<std::string> known_;
};

}  // namespace hl
